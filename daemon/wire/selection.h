#pragma once

#include "wire/filter.h"

namespace limb_ring::capture {

/// What one observer has asked for.
struct Choice {
  Filter filter;
  std::uint32_t sample = 1;       ///< of the packets that pass the filter, every so many-th
  std::uint32_t limit_per_s = 0;  ///< at most so many in any whole second; 0: no limit
};

/// Chooses packets for one observer, and counts what it leaves out, and why.
class Selection {
 public:
  explicit Selection(const Choice& choice) : choice_(choice) {}

  /// Whether the observer gets this packet; where not, the reason is counted.
  bool takes(const PacketView& packet);
  /// What became of one that was taken.
  void given() {
    ++counts_.given;
    lost_before_ = 0;
  }
  void lost() {
    ++counts_.lost;
    ++lost_before_;
  }
  const Filter& filter() const { return choice_.filter; }
  /// Lost since one was given.
  std::uint32_t lost_before() const { return lost_before_; }
  const CaptureCounts& counts() const { return counts_; }

 private:
  bool within_limit(std::chrono::nanoseconds at);

  Choice choice_;
  CaptureCounts counts_;
  std::uint32_t lost_before_ = 0;
  std::uint64_t passed_ = 0;
  std::int64_t second_ = -1;
  std::uint32_t in_second_ = 0;
};

}  // namespace limb_ring::capture
