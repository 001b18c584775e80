#pragma once

#include <chrono>
#include <cstdint>
#include <ratio>

namespace limb_ring::core {

/// Picoseconds, so that one byte at any usual data rate is a whole number (8 ns at 1 Gbit/s).
/// 64 bits hold 106 days; the daemon counts from its own start. (ours)
using Duration = std::chrono::duration<std::int64_t, std::pico>;

/// The core has no clock of its own: whoever drives it says what time it is.
struct RingClock {
  using duration = Duration;
  using rep = Duration::rep;
  using period = Duration::period;
  using time_point = std::chrono::time_point<RingClock>;
  static constexpr bool is_steady = true;
};
using Time = RingClock::time_point;

constexpr Time kNever = Time::max();

}  // namespace limb_ring::core
