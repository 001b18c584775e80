#pragma once

#include <algorithm>

namespace limb_ring::link {

/// Whether a socket is read once more in the same turn of the event loop. Behind a packet that comes alone there is
/// nothing, and the read would be a system call in vain for each packet; where packets pile up, reading them all keeps
/// a loaded ring fast. So reading goes on while it mostly finds something; else every kTryEvery-th turn tries. (ours)
class ReadAgain {
 public:
  static constexpr unsigned kTryEvery = 16;
  static constexpr unsigned kMostCredit = 8;

  bool wanted() { return credit_ > 0 || ++turns_ % kTryEvery == 0; }
  /// After each such read.
  void found(bool something) { credit_ = something ? std::min(credit_ + 1, kMostCredit) : credit_ / 2; }

 private:
  unsigned credit_ = 0;  ///< one more by each read that found something, half by one that did not
  unsigned turns_ = 0;   ///< without credit
};

}  // namespace limb_ring::link
