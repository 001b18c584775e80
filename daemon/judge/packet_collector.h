#pragma once

#include <array>
#include <cstring>

#include "core/time.h"
#include "wire/slice.h"

namespace limb_ring::sim {

/// Puts the DATP together whose slices pass, as a receiver does: one that breaks off, stalls or is too long is dropped.
/// (protocol.md section 2.6)
class PacketCollector {
 public:
  /// @param stall the longest pause between two slices of a DATP
  explicit PacketCollector(core::Duration stall) : stall_(stall) {}

  bool open() const { return open_; }
  /// Bytes of the DATP that have come in; also after it was broken off, or is whole.
  std::size_t size() const { return size_; }
  void drop() { open_ = false; }
  /// True if the DATP is given up by now. A slice in the very instant at which it would be still belongs to it.
  bool stalled(core::Time now) const { return open_ && last_ + stall_ < now; }

  template <class Archive>
  void archive(Archive& a) {
    a("open", open_)("size", size_)("last", last_)("bytes", bytes_, open_ ? size_ : 0);
  }

  /// @return the packet where this slice is its end, valid until the next one; else nothing
  wire::ByteView put(const wire::Slice& slice, core::Time now) {
    using wire::SliceKind;
    if (slice.kind == SliceKind::whole) return size_ = slice.bytes.size, open_ = false, slice.bytes;
    if (slice.kind == SliceKind::abort) return open_ = false, wire::ByteView{};
    const bool begins = slice.kind == SliceKind::start;
    if (begins) size_ = 0;
    if (!begins && (!open_ || (slice.kind != SliceKind::more && slice.kind != SliceKind::end))) return {};
    const bool ends = slice.kind == SliceKind::end;
    const std::size_t most = ends ? wire::kMaxDataPacketSize : wire::kHeaderSize + wire::kMaxPayload;
    open_ = size_ + slice.bytes.size <= most;
    if (!open_) return {};
    std::memcpy(bytes_.data() + size_, slice.bytes.data, slice.bytes.size);
    size_ += slice.bytes.size;
    last_ = now;
    if (!ends) return {};
    open_ = false;
    return size_ < wire::kMinDataPacketSize ? wire::ByteView{} : wire::ByteView{bytes_.data(), size_};
  }

 private:
  core::Duration stall_;
  bool open_ = false;
  std::size_t size_ = 0;
  core::Time last_{};
  std::array<std::uint8_t, wire::kMaxDataPacketSize> bytes_;
};

}  // namespace limb_ring::sim
