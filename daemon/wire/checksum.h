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

/// The other way round, for four bytes: what to XOR into them, the first in the lowest byte, so that the CRC of the run
/// is XORed with `change`. (ours)
/// @param bytes_after how many bytes of the run follow them
std::uint32_t crc32_cause(std::uint32_t change, std::size_t bytes_after);

}  // namespace limb_ring::wire
