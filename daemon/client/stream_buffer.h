#pragma once

#include <cstring>

#include "client/frame.h"

namespace limb_ring::client {

/// Bytes read from a stream and not yet used: a flat run, so that frames can be looked at in
/// place. Grows to the largest frame seen and stays so.
class StreamBuffer {
 public:
  wire::ByteView view() const { return {bytes_.data() + begin_, end_ - begin_}; }
  bool empty() const { return begin_ == end_; }

  /// Room for `size` bytes behind the last one; valid until the next call. See added().
  std::uint8_t* space(std::size_t size) {
    if (bytes_.size() - end_ < size) make_room(size);
    return bytes_.data() + end_;
  }
  void added(std::size_t size) { end_ += size; }
  /// @pre size <= view().size
  void used(std::size_t size) {
    begin_ += size;
    if (begin_ == end_) clear();
  }
  void clear() { begin_ = end_ = 0; }

 private:
  void make_room(std::size_t size) {
    if (begin_ > 0) std::memmove(bytes_.data(), bytes_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
    if (bytes_.size() - end_ < size) bytes_.resize(end_ + size);
  }

  Bytes bytes_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace limb_ring::client
