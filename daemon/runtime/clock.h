#pragma once

#include <chrono>

#include "core/time.h"

namespace limb_ring::runtime {

/// The clock of the daemon: CLOCK_MONOTONIC, counted from its start, as the core
/// wants it. A steady time is rounded up, so that a timer never fires before its deadline.
class Clock {
 public:
  using Steady = std::chrono::steady_clock;

  core::Time now() const { return at(Steady::now()); }
  core::Time at(Steady::time_point when) const { return core::Time{} + (when - start_); }
  Steady::time_point steady(core::Time when) const {
    return start_ + std::chrono::duration_cast<std::chrono::nanoseconds>(when.time_since_epoch()) +
           std::chrono::nanoseconds(1);
  }
  std::chrono::nanoseconds uptime() const { return Steady::now() - start_; }

 private:
  Steady::time_point start_ = Steady::now();
};

}  // namespace limb_ring::runtime
