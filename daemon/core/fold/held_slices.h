#pragma once

#include <vector>

#include "wire/slice.h"

namespace limb_ring::core {

/// Slices of the first line that wait until the second has drained, in their order, and then until there is room.
class HeldSlices {
 public:
  bool empty() const { return first_ == slices_.size(); }
  /// Bytes of those that are in.
  std::size_t bytes() const { return bytes_.size() - popped_bytes(); }
  void put(const wire::Slice& slice) {
    if (popped_bytes() > bytes()) forget_popped();
    slices_.push_back({slice.kind, bytes_.size(), slice.bytes.size});
    bytes_.insert(bytes_.end(), slice.bytes.begin(), slice.bytes.end());
  }
  /// Valid until the next put(). @pre !empty()
  wire::Slice front() const {
    const Held& held = slices_[first_];
    return {held.kind, wire::ByteView{bytes_.data(), bytes_.size()}.from(held.at).first(held.size)};
  }
  void pop() {
    ++first_;
    if (empty()) clear();
  }
  /// How many are in.
  std::size_t count() const { return slices_.size() - first_; }
  void clear() {
    slices_.clear();
    bytes_.clear();
    first_ = 0;
  }

  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    forget_popped();
    a("slices", slices_)("bytes", bytes_);
  }

 private:
  struct Held {
    wire::SliceKind kind;
    std::size_t at, size;  ///< in bytes_
    template <class Archive>
    void archive(Archive& a) {
      a("kind", kind)("at", at)("size", size);
    }
  };
  std::size_t popped_bytes() const { return empty() ? 0 : slices_[first_].at; }
  // Under load it may never be empty, and must not grow.
  void forget_popped() {
    const std::size_t popped = popped_bytes();
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(popped));
    slices_.erase(slices_.begin(), slices_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
    for (Held& held : slices_) held.at -= popped;
  }

  std::vector<Held> slices_;
  std::vector<std::uint8_t> bytes_;
  std::size_t first_ = 0;
};

}  // namespace limb_ring::core
