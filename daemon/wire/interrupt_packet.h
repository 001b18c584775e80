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

using InterruptBytes = std::array<std::uint8_t, kInterruptPacketSize>;

}  // namespace limb_ring::wire
