#pragma once

#include "recorder/record.h"

/// What RecordWriter writes and RecordReader reads (ours), in the byte order of the machine, as a recording is replayed
/// by the same program. A record:
///
///     | tag 8 | time since the record before 64; 128 or none where the tag says so | what it is of |
///
/// The slices that were written to a line:
///
///     | line 8 | bytes in all 32 | slices: | kind 8 | back 32 | size 16 | differing 8 | words: 64 |
///                                          | kind 8 | 0 32    | size 32 | bytes |
///
/// `back` bytes before its record lies the slice that was taken in, and passed on but for some words at its ends
/// (Differences in slices_taken_in.h).
namespace limb_ring::recorder {

/// @name Tags of records. An input's tag is its index in core::Input
///@{
constexpr std::uint8_t kInputTags = std::variant_size_v<core::Input>;
constexpr std::uint8_t kWrittenTag = kInputTags, kEventTag = kInputTags + 1, kPacketTag = kInputTags + 2;
/// Added to a tag: at the same time as the record before; or so much later that it takes 128 bits.
constexpr std::uint8_t kSameTime = 0x80, kMuchLater = 0x40;
static_assert(kPacketTag < kMuchLater);
///@}

/// Bytes that may be written to a line at once.
constexpr std::size_t kMostWritten = 1u << 22;

}  // namespace limb_ring::recorder
