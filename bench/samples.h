#pragma once

#include <chrono>
#include <vector>

#include "bench/measurement.h"

namespace limb_ring::bench {

/// Round trips of one sender, one after the other, for so long.
class Samples {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Samples(double seconds);
  void begin(Clock::time_point now) { begun_ = last_ = now; }
  /// A packet is back, and the next one goes. @return false once the time is over
  bool lap(Clock::time_point now);
  Measurement measurement();

 private:
  Clock::duration duration_;
  Clock::time_point begun_, last_;
  std::vector<Clock::duration> laps_;
};

}  // namespace limb_ring::bench
