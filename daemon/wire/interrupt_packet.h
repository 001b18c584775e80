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

inline Factor factor_of(std::uint8_t last) { return Factor{static_cast<std::uint8_t>(last & 7)}; }

/// An INTP as a plain value.
struct InterruptPacket {
  Code code{true};
  std::uint8_t hop = 0;
  NodeId source{0};
  std::uint8_t fbc = kFbcUntaken;
  NodeId destination{0};
  Factor factor{};
};

using InterruptBytes = std::array<std::uint8_t, kInterruptPacketSize>;
InterruptBytes encode(const InterruptPacket& packet);

/// @return PacketError::none where everything (CRC and the unused bits of INT included) is right
PacketError decode(ByteView bytes, InterruptPacket& packet);

}  // namespace limb_ring::wire
