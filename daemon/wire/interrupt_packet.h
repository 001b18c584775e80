#pragma once

#include <array>

#include "wire/packet.h"

namespace limb_ring::wire {

/// INTP, an interrupt packet (paper):
///
///   | Code | SOP | HOP | SID | EOP | FBC | DID | INT | CRC 4 B |      12 bytes
///
/// INT: bits 2..0 the factor 0..7, the rest 0.
constexpr std::size_t kInterruptPacketSize = kOverhead;
constexpr std::uint8_t kFactors = 8;

/// An INTP as a plain value.
struct InterruptPacket {
  Code code{true, 0, 0};
  std::uint8_t hop = 0;
  NodeId source = 0;
  std::uint8_t fbc = kFbcUntaken;
  NodeId destination = 0;
  std::uint8_t factor = 0;  ///< 0..7
};

using InterruptBytes = std::array<std::uint8_t, kInterruptPacketSize>;
InterruptBytes encode(const InterruptPacket& packet);

/// @return PacketError::none where everything (CRC and the unused bits of INT included) is right
PacketError decode(ByteView bytes, InterruptPacket& packet);

}  // namespace limb_ring::wire
