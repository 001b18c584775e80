#pragma once

#include <chrono>

#include "core/time.h"

namespace limb_ring::runtime {

/// The clock of the daemon: CLOCK_MONOTONIC, counted from its start, as the core
/// wants it. A steady time is rounded up, so that a timer never fires before its deadline.
class Clock {
 public:
  using Steady = std::chrono::steady_clock;

  /// @param start of the time of the core, not after now
  explicit Clock(Steady::time_point start = Steady::now()) : start_(start) {}

  core::Time now() const { return at(Steady::now()); }
  core::Time at(Steady::time_point when) const { return core::Time{} + (when - start_); }
  /// The last instant a steady clock knows (292 years), where `when` is later or kNever.
  Steady::time_point steady(core::Time when) const {
    const core::Duration since = when.time_since_epoch();
    if (since >= Steady::time_point::max() - start_) return Steady::time_point::max();
    return start_ + core::whole_nanoseconds(since) + std::chrono::nanoseconds(1);
  }

 private:
  Steady::time_point start_;
};

}  // namespace limb_ring::runtime
