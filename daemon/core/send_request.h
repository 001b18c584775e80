#pragma once

#include "core/events.h"
#include "wire/data_packet.h"

namespace limb_ring::core {

/// A DATP to be sent.
struct SendRequest {
  Owner owner = kController;
  std::uint32_t token = 0;  ///< given back in SendEnded
  NodeId destination = 0;   ///< 0..254, or wire::kBroadcast
  wire::Priority priority{};
  wire::ChannelId channel{};  ///< 1 is the network controllers' own
  wire::ByteView data;        ///< 1..512 bytes; copied
};

/// An INTP to be sent.
struct InterruptRequest {
  Owner owner = kController;
  std::uint32_t token = 0;
  NodeId destination = 0;  ///< 0..254, or wire::kBroadcast
  wire::Factor factor{};
};

}  // namespace limb_ring::core
