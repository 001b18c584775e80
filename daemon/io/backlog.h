#pragma once

#include <cstdint>
#include <vector>

#include "wire/bytes.h"

namespace limb_ring::event_loop {

/// Bytes a socket has not taken yet, in order, up to a limit.
class Backlog {
 public:
  explicit Backlog(std::size_t limit) : limit_(limit) {}

  bool empty() const { return done_ == bytes_.size(); }
  std::size_t size() const { return bytes_.size() - done_; }
  /// In memory: those too that have gone out and are still in front of the others.
  std::size_t kept() const { return bytes_.size(); }
  wire::ByteView view() const { return {bytes_.data() + done_, size()}; }

  /// @return false: too much; nothing was added.
  bool add(wire::ByteView more) {
    if (size() + more.size > limit_) return false;
    std::vector<std::uint8_t>& bytes = to_append();
    bytes.insert(bytes.end(), more.begin(), more.end());
    return true;
  }
  /// For a writer that appends; until the next call. What it has appended may be too much: see is_over_limit().
  std::vector<std::uint8_t>& to_append() {
    drop_done();
    return bytes_;
  }
  bool is_over_limit() const { return size() > limit_; }
  void remove(std::size_t count) {
    done_ += count;
    if (empty()) clear();
  }
  void clear() {
    bytes_.clear();
    done_ = 0;
  }

 private:
  /// One that is never empty would grow for ever. Moving the rest to the front is expensive, so it is done only when at
  /// least as much has gone out.
  void drop_done() {
    if (done_ < size()) return;
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(done_));
    done_ = 0;
  }

  std::size_t limit_;
  std::vector<std::uint8_t> bytes_;
  std::size_t done_ = 0;
};

}  // namespace limb_ring::event_loop
