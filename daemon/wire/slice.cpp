#include "wire/slice.h"

#include <algorithm>
#include <cstring>

#include "wire/packet.h"

namespace limb_ring::wire {
namespace {

constexpr std::size_t kTail = kTrailerSize + kCrcSize;

}  // namespace

bool slice_size_fits(SliceKind kind, std::size_t size) {
  switch (kind) {
    case SliceKind::start:
      return size >= kHeaderSize && size <= kHeaderSize + kMaxPayload && size % kWord == 0;
    case SliceKind::more:
      return size >= kWord && size <= kMaxPayload && size % kWord == 0;
    case SliceKind::end:
      return size >= kTail && size <= kTail + kMaxPayload;
    case SliceKind::whole:
      return size >= kMinDataPacketSize && size <= kMaxDataPacketSize;
    case SliceKind::interrupt:
      return size == kInterruptPacketSize;
    case SliceKind::abort:
    case SliceKind::idle:
      return size == 0;
    case SliceKind::fold:
      return size == kFoldWordSize;
  }
  return false;
}

SliceParse parse_slice(ByteView bytes) {
  using Status = SliceParse::Status;
  if (bytes.size < kSliceHeaderSize) {
    const bool wrong = !bytes.empty() && bytes[kSliceMagicAt] != kSliceMagic;
    return {wrong ? Status::malformed : Status::incomplete, {}, 0};
  }
  const auto kind = static_cast<SliceKind>(bytes[kSliceKindAt]);
  const std::size_t size = load_u16(bytes.data + kSliceSizeAt);
  if (bytes[kSliceMagicAt] != kSliceMagic || !slice_size_fits(kind, size)) return {Status::malformed, {}, 0};
  if (bytes.size < kSliceHeaderSize + size) return {Status::incomplete, {}, 0};
  return {Status::slice, {kind, bytes.from(kSliceHeaderSize).first(size)}, kSliceHeaderSize + size};
}

std::uint8_t* SliceWriter::put_space(SliceKind kind, std::size_t size) {
  const std::size_t at = size_;
  size_ += kSliceHeaderSize + size;
  if (buffer_.size() < size_) buffer_.resize(std::max(kMaxSliceSize, 2 * size_));
  std::uint8_t* p = buffer_.data() + at;
  p[kSliceMagicAt] = kSliceMagic;
  p[kSliceKindAt] = static_cast<std::uint8_t>(kind);
  store_u16(p + kSliceSizeAt, static_cast<std::uint16_t>(size));
  return p + kSliceHeaderSize;
}

void SliceWriter::take(SliceWriter& other) {
  if (size_ == 0) {
    swap(other);
  } else if (!other.empty()) {
    const std::size_t at = size_;
    size_ += other.size_;
    if (buffer_.size() < size_) buffer_.resize(2 * size_);
    std::memcpy(buffer_.data() + at, other.buffer_.data(), other.size_);
  }
  other.clear();
}

void SliceWriter::put(SliceKind kind, ByteView bytes) {
  std::uint8_t* p = put_space(kind, bytes.size);
  if (!bytes.empty()) std::memcpy(p, bytes.data, bytes.size);
}

}  // namespace limb_ring::wire
