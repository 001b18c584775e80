#pragma once

#include <cstdint>

namespace limb_ring::link {

/// Discards what comes late or twice on a line that may reorder or double datagrams. (ours, protocol.md section 6.7)
class SequenceCheck {
 public:
  struct Arrival {
    bool fresh;          ///< false: lower or equal to one already seen; discard
    std::uint32_t lost;  ///< so many before this one are missing
  };
  /// A session's first number is 1. Numbers wrap.
  Arrival check(std::uint32_t sequence) {
    const std::uint32_t ahead = sequence - next_;
    if (ahead >= 0x80000000u) return {false, 0};
    next_ = sequence + 1;
    return {true, ahead};
  }
  void restart() { next_ = 1; }

 private:
  std::uint32_t next_ = 1;
};

}  // namespace limb_ring::link
