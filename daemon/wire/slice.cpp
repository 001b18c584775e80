#include "wire/slice.h"

#include <algorithm>
#include <cstring>

namespace limb_ring::wire {

bool slice_size_fits(SliceKind kind, std::size_t size) {
  switch (kind) {
    case SliceKind::start: return size >= 4 && size <= 4 + 512 && size % 4 == 0;
    case SliceKind::more: return size >= 4 && size <= 512 && size % 4 == 0;
    case SliceKind::end: return size >= 8 && size <= 8 + 512;
    case SliceKind::whole: return size >= 13 && size <= 524;
    case SliceKind::interrupt: return size == 12;
    case SliceKind::abort:
    case SliceKind::idle: return size == 0;
    case SliceKind::fold: return size == kFoldWordSize;
  }
  return false;
}

SliceParse parse_slice(ByteView bytes) {
  using Status = SliceParse::Status;
  if (bytes.size < kSliceHeaderSize) {
    const bool wrong = !bytes.empty() && bytes[0] != kSliceMagic;
    return {wrong ? Status::malformed : Status::incomplete, {}, 0};
  }
  const auto kind = static_cast<SliceKind>(bytes[1]);
  const std::size_t size = load_u16(bytes.data + 2);
  if (bytes[0] != kSliceMagic || !slice_size_fits(kind, size)) return {Status::malformed, {}, 0};
  if (bytes.size < kSliceHeaderSize + size) return {Status::incomplete, {}, 0};
  return {Status::slice, {kind, bytes.from(kSliceHeaderSize).first(size)}, kSliceHeaderSize + size};
}

std::uint8_t* SliceWriter::put_space(SliceKind kind, std::size_t size) {
  const std::size_t at = size_;
  size_ += kSliceHeaderSize + size;
  if (buffer_.size() < size_) buffer_.resize(std::max(kMaxSliceSize, 2 * size_));
  std::uint8_t* p = buffer_.data() + at;
  p[0] = kSliceMagic;
  p[1] = static_cast<std::uint8_t>(kind);
  store_u16(p + 2, static_cast<std::uint16_t>(size));
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
