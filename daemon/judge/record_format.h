#pragma once

#include "judge/record.h"

/// What RecordWriter writes and RecordReader reads (ours), in the byte order of the machine, as a recording is replayed
/// by the same program. A record:
///
///     | tag 8 | time since the record before 64; 128 or none where the tag says so | what it is of |
///
/// A slice that came in, and one of which the data is left out (abridged.h):
///
///     | line 8 | kind 8 | size 32 | bytes |        | line 8 | kind 8 + kAbridged | size 32 | header, trailer, CRC 96 |
///
/// The slices that were written to a line, each as put_slices() writes it:
///
///     | line 8 | bytes in all 32 | slices |
namespace limb_ring::recorder {

/// @name Tags of records. An input's tag is its index in core::Input
///@{
constexpr std::uint8_t kInputTags = std::variant_size_v<core::Input>;
constexpr std::uint8_t kWrittenTag = kInputTags, kEventTag = kInputTags + 1, kPacketTag = kInputTags + 2;
/// Added to a tag: at the same time as the record before; or so much later that it takes 128 bits.
constexpr std::uint8_t kSameTime = 0x80, kMuchLater = 0x40;
static_assert(kPacketTag < kMuchLater);
///@}

}  // namespace limb_ring::recorder
