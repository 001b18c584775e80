#pragma once

#include <chrono>

namespace limb_ring::bridge {

/// Lets one warning through per period, by the steady clock: roscpp's own throttled warnings
/// stay silent under use_sim_time while /clock does.
class Throttle {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Throttle(Clock::duration period) : period_(period) {}
  bool allow(Clock::time_point now = Clock::now()) {
    if (now < next_) return false;
    next_ = now + period_;
    return true;
  }

 private:
  Clock::duration period_;
  Clock::time_point next_{};
};

}  // namespace limb_ring::bridge
