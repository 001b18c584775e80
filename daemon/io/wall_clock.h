#pragma once

#include <chrono>
#include <cstdint>

namespace limb_ring::process {

/// Converts instants of CLOCK_MONOTONIC to CLOCK_REALTIME. The difference of the two is measured once a
/// second: packets of one batch keep their distances, and a wall clock that is set is soon followed.
class WallClock {
 public:
  using Steady = std::chrono::steady_clock;

  /// ns since 1970
  std::int64_t at(Steady::time_point when) {
    if (when - measured_ >= std::chrono::seconds(1)) measure(when);
    return when.time_since_epoch().count() + offset_;
  }

 private:
  // The shortest of three readings counts: during that one the process was held up least.
  void measure(Steady::time_point when) {
    measured_ = when;
    auto shortest = Steady::duration::max();
    for (int i = 0; i < 3; ++i) {
      const auto before = Steady::now();
      const std::chrono::nanoseconds wall = std::chrono::system_clock::now().time_since_epoch();
      const auto took = Steady::now() - before;
      if (took >= shortest) continue;
      shortest = took;
      offset_ = (wall - before.time_since_epoch() - took / 2).count();
    }
  }

  Steady::time_point measured_{-std::chrono::hours(1)};
  std::int64_t offset_ = 0;
};

}  // namespace limb_ring::process
