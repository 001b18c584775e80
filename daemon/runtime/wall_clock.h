#pragma once

#include <chrono>
#include <cstdint>

namespace limb_ring::runtime {

/// CLOCK_REALTIME of instants of CLOCK_MONOTONIC. How far apart the two are is looked up once a
/// second: packets of one batch keep their distances, and a clock that is set is soon followed.
class WallClock {
 public:
  using Steady = std::chrono::steady_clock;

  /// ns since 1970
  std::int64_t at(Steady::time_point when) {
    if (when - looked_ >= std::chrono::seconds(1)) look(when);
    return when.time_since_epoch().count() + offset_;
  }

 private:
  // Of three looks the one during which the process was held up least.
  void look(Steady::time_point when) {
    looked_ = when;
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

  Steady::time_point looked_{-std::chrono::hours(1)};
  std::int64_t offset_ = 0;
};

}  // namespace limb_ring::runtime
