#pragma once

#include "core/events.h"
#include "wire/bytes.h"

namespace limb_ring::core {

/// A DATP to be sent.
struct SendRequest {
  Owner owner = kController;
  std::uint32_t token = 0;     ///< given back in SendEnded
  NodeId destination = 0;      ///< 0..254, or wire::kBroadcast
  std::uint8_t priority = 0;   ///< 0 (highest) to 3
  std::uint8_t channel = 0;    ///< 0..63; 1 is the network controllers' own
  wire::ByteView data;         ///< 1..512 bytes; copied
};

/// An INTP to be sent.
struct InterruptRequest {
  Owner owner = kController;
  std::uint32_t token = 0;
  NodeId destination = 0;   ///< 0..254, or wire::kBroadcast
  std::uint8_t factor = 0;  ///< 0..7
};

}  // namespace limb_ring::core
