#pragma once

#include <cstdint>
#include <vector>

#include "wire/bytes.h"

namespace limb_ring::link {

/// Bytes a socket has not taken yet, in order, up to a limit.
class Backlog {
 public:
  /// Far above what one batch brings: the Packet Manager writes only while nothing waits.
  static constexpr std::size_t kLimit = 1 << 20;

  bool empty() const { return done_ == bytes_.size(); }
  std::size_t size() const { return bytes_.size() - done_; }
  /// In memory: those too that have gone out and are still in front of the others.
  std::size_t kept() const { return bytes_.size(); }
  wire::ByteView view() const { return {bytes_.data() + done_, size()}; }

  /// @return false: too much; nothing was added.
  bool add(wire::ByteView more) {
    if (size() + more.size > kLimit) return false;
    drop_done();
    bytes_.insert(bytes_.end(), more.begin(), more.end());
    return true;
  }
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

  std::vector<std::uint8_t> bytes_;
  std::size_t done_ = 0;
};

}  // namespace limb_ring::link
