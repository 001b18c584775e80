#pragma once

#include "wire/slice.h"

namespace limb_ring::core {

/// Slices of the first line that wait until the second has drained, in their order, and then until there is room.
class HeldSlices {
 public:
  bool empty() const { return slices_.empty(); }
  /// Bytes that were put in since it was last empty.
  std::size_t bytes() const { return slices_.view().size; }
  void put(const wire::Slice& slice) { slices_.put(slice.kind, slice.bytes); }
  /// The next one is still in. @pre !empty() @return false where all are out, and it is empty now
  bool next(wire::Slice& out) {
    if (taken_ == bytes()) {
      slices_.clear();
      taken_ = 0;
      return false;
    }
    out = wire::parse_slice(slices_.view().from(taken_)).slice;
    return true;
  }
  /// That one, which next() gave, is out.
  void pop(const wire::Slice& slice) { taken_ += wire::kSliceHeaderSize + slice.bytes.size; }

 private:
  wire::SliceWriter slices_;
  std::size_t taken_ = 0;  ///< bytes
};

/// Whether a DATP is under way on a line, from the slices that pass.
class OpenPacket {
 public:
  bool is_open() const { return open_; }
  void see(const wire::Slice& slice) {
    const bool inside = slice.kind == wire::SliceKind::more || slice.kind == wire::SliceKind::interrupt;
    open_ = slice.kind == wire::SliceKind::start || (open_ && inside);
  }
  void close() { open_ = false; }

 private:
  bool open_ = false;
};

}  // namespace limb_ring::core
