#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <ratio>

namespace limb_ring::core {

/// A whole number of 128 bits. GCC and Clang have it, C++17 has not.
__extension__ typedef __int128 Int128;

}  // namespace limb_ring::core

/// The standard library knows the range of Int128 only with GNU extensions; without them it says 0.
template <>
struct std::chrono::duration_values<limb_ring::core::Int128> {
  using Int128 = limb_ring::core::Int128;
  static constexpr Int128 zero() noexcept { return 0; }
  static constexpr Int128 max() noexcept { return ~min(); }
  static constexpr Int128 min() noexcept { return -(Int128{1} << 126) * 2; }
};

namespace limb_ring::core {

/// Picoseconds, so that one byte at any usual data rate is a whole number (8 ns at 1 Gbit/s). A robot
/// may stay on for years, and 64 bits would hold only 106 days of them. (ours)
using Duration = std::chrono::duration<Int128, std::pico>;

/// The core has no clock of its own: its driver passes the time in.
struct RingClock {
  using duration = Duration;
  using rep = Duration::rep;
  using period = Duration::period;
  using time_point = std::chrono::time_point<RingClock>;
  static constexpr bool is_steady = true;
};
using Time = RingClock::time_point;

/// A span in picoseconds as 64 bits, for text, random draws and traces; clamped to 0 and 106 days.
constexpr std::int64_t picoseconds(Duration span) {
  constexpr Duration most{std::numeric_limits<std::int64_t>::max()};
  return static_cast<std::int64_t>((span < Duration{0} ? Duration{0} : span < most ? span : most).count());
}

/// A span in whole nanoseconds, rounded towards 0. Of up to 106 days it is divided in 64 bits; in 128 that takes ten
/// times as long.
constexpr std::chrono::nanoseconds whole_nanoseconds(Duration span) {
  const auto low = static_cast<std::int64_t>(span.count());
  if (low == span.count()) return std::chrono::nanoseconds(low / 1000);
  return std::chrono::duration_cast<std::chrono::nanoseconds>(span);
}

constexpr Time kNever = Time::max();

}  // namespace limb_ring::core
