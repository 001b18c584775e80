#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "wire/packet.h"

namespace limb_ring::wire {

/// What travels on a link (ours, protocol.md section 6.2). Slices keep control and data apart, as
/// the fibre's line code does: any payload byte is legal, an INTP can sit inside a DATP, and a
/// relay can pass on what has arrived.
///
///   | magic 0xA7 | kind 8 | size 16, big-endian | size bytes |
///
/// A DATP travels either as one `whole`, or as `start` (`more`)* (`end` | `abort`):
///   start  header (4 B) and whole words of payload
///   more   whole words of payload
///   end    the rest of the payload, trailer and CRC (8 B at least)
/// `fold` is a word of a ring that folds back.
enum class SliceKind : std::uint8_t { start = 1, more, end, whole, interrupt, abort, idle, fold };

constexpr std::size_t kFoldWordSize = 3;

struct Slice {
  SliceKind kind;
  ByteView bytes;
  std::optional<bool> crc_checked{};  ///< of a whole DATP: it is right or wrong, if somebody has looked already

  /// @pre a whole DATP
  bool crc_good() const { return crc_checked ? *crc_checked : PacketFields{bytes}.crc_good(); }
};

constexpr std::size_t kSliceHeaderSize = 4;
constexpr std::size_t kSliceMagicAt = 0, kSliceKindAt = 1, kSliceSizeAt = 2;
constexpr std::uint8_t kSliceMagic = 0xA7;
constexpr std::size_t kMaxSliceSize = kSliceHeaderSize + kMaxDataPacketSize;

/// True if `size` is one that `kind` may have.
bool slice_size_fits(SliceKind kind, std::size_t size);

/// Reads one slice from the front of `bytes`.
/// @return `consumed` bytes were used and `slice` points into `bytes`; `incomplete`: more bytes
///         are needed; `malformed`: this is not a slice, and what follows cannot be trusted.
struct SliceParse {
  enum class Status { slice, incomplete, malformed } status;
  Slice slice;
  std::size_t consumed;
};
SliceParse parse_slice(ByteView bytes);

/// Calls visit(slice) for each slice, in order. @pre `framed` is what a SliceWriter has put together
template <class Visit>
void each_slice(ByteView framed, Visit visit) {
  while (!framed.empty()) {
    const ByteView bytes = framed.from(kSliceHeaderSize).first(load_u16(framed.data + kSliceSizeAt));
    visit(Slice{static_cast<SliceKind>(framed[kSliceKindAt]), bytes});
    framed = framed.from(kSliceHeaderSize + bytes.size);
  }
}

/// Slices in the order in which they go onto one line, framed, ready to be written.
class SliceWriter {
 public:
  void put(SliceKind kind, ByteView bytes);
  /// As put, with the bytes left for the caller to fill: `size` bytes, valid until the next call.
  std::uint8_t* put_space(SliceKind kind, std::size_t size);
  ByteView view() const { return {buffer_.data(), size_}; }
  bool empty() const { return size_ == 0; }
  void clear() { size_ = 0; }
  /// Adds all of `other` behind what is there; leaves `other` empty.
  void take(SliceWriter& other);
  void swap(SliceWriter& other) {
    buffer_.swap(other.buffer_);
    std::swap(size_, other.size_);
  }

 private:
  std::vector<std::uint8_t> buffer_;
  std::size_t size_ = 0;
};

}  // namespace limb_ring::wire
