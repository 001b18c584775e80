#pragma once

#include <cstdint>

#include "wire/bytes.h"

namespace limb_ring::wire {

/// CRC-32 of IEEE 802.3 (reflected, polynomial 0x04C11DB7, start and end inverted). Width from
/// the paper, the rest ours.
std::uint32_t crc32(ByteView bytes);

/// What to XOR into the CRC of a run of bytes when one of them is XORed with `delta` and
/// `bytes_after` bytes of the run follow it. CRC is linear, so a good CRC stays good and a bad
/// one bad: a relay never launders an error. The cost does not depend on the length. (ours, protocol.md
/// section 3.7)
/// @pre bytes_after <= 520
std::uint32_t crc32_change(std::uint8_t delta, std::size_t bytes_after);

}  // namespace limb_ring::wire
