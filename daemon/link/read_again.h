#pragma once

#include <algorithm>

namespace limb_ring::link {

/// Whether a socket is read once more in the same turn. A packet that comes alone most likely is, and a read that finds
/// nothing is a system call for each packet; where packets pile up, to read them all is what keeps a loaded ring fast.
/// So it is gone on with for as long as it finds something, and else tried now and then. (ours)
class ReadAgain {
 public:
  static constexpr unsigned kTryEvery = 16;
  static constexpr unsigned kMostLuck = 8;

  bool wanted() { return luck_ > 0 || ++turns_ % kTryEvery == 0; }
  /// After each such read.
  void found(bool something) { luck_ = something ? std::min(luck_ + 1, kMostLuck) : luck_ / 2; }

 private:
  unsigned luck_ = 0;
  unsigned turns_ = 0;
};

}  // namespace limb_ring::link
