#pragma once

#include "recorder/record.h"

/// What RecordWriter writes and RecordReader reads (ours), in the byte order of the machine, as a recording is replayed
/// by the same program. A record:
///
///     | tag 8 | time step, 1 to 19 bytes; none where the tag says "same time" | what it is of |
///
/// The slices that were written to a line:
///
///     | line 8 | bytes in all 32 | slices: | kind 8 | back 32 | size 16 | n 8 | n times: place 16, byte 8 |
///                                          | kind 8 | 0 32    | size 32 | bytes |
///
/// `back` bytes before its record lies the slice that was taken in, and passed on but for n bytes (slices_taken_in.h).
namespace limb_ring::recorder {

/// @name Tags of records. An input's tag is its index in core::Input
///@{
constexpr std::uint8_t kInputTags = std::variant_size_v<core::Input>;
constexpr std::uint8_t kWrittenTag = kInputTags, kEventTag = kInputTags + 1, kPacketTag = kInputTags + 2;
/// Added to a tag: at the same time as the record before.
constexpr std::uint8_t kSameTime = 0x80;
static_assert(kPacketTag < kSameTime);
///@}

/// Bytes that may be written to a line at once.
constexpr std::size_t kMostWritten = 1u << 22;

/// As core::Int128.
__extension__ typedef unsigned __int128 Unsigned128;

/// From one record's time to the next one's: zigzag and LEB128, 1 to 19 bytes, since most steps are short.
class TimeStep {
 public:
  explicit TimeStep(core::Duration step = {}) : step_(step) {}
  core::Duration value() const { return step_; }

  template <class Archive>
  void archive(Archive& a) {
    const core::Int128 count = step_.count();
    Unsigned128 rest = static_cast<Unsigned128>(count) << 1 ^ static_cast<Unsigned128>(count >> 127);
    Unsigned128 read = 0;
    std::uint8_t byte = 0x80;
    for (unsigned shift = 0; (byte & 0x80) != 0 && shift < 133; shift += 7, rest >>= 7) {
      byte = static_cast<std::uint8_t>((rest & 0x7F) | (rest > 0x7F ? 0x80 : 0));
      a("byte", byte);
      read |= static_cast<Unsigned128>(byte & 0x7F) << shift;
    }
    step_ = core::Duration{static_cast<core::Int128>(read >> 1) ^ -static_cast<core::Int128>(read & 1)};
  }

 private:
  core::Duration step_;
};

}  // namespace limb_ring::recorder
