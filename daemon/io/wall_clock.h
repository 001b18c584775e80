#pragma once

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <optional>

namespace limb_ring::process {

/// The wall clock as its distance from the monotonic one, and what that was before the clock was last set. Time is an
/// argument. (ours, protocol.md section 9.1)
///
/// All processes of a host see a step of its wall clock at once, but what was stamped before it may come after it: for
/// a second the former distance counts too, if a stamp is nearer to now by it.
class WallOffset {
 public:
  using nanoseconds = std::chrono::nanoseconds;

  /// By less than this a wall clock is slewed, not set.
  static constexpr nanoseconds kStep = std::chrono::milliseconds(1);
  static constexpr nanoseconds kRemembered = std::chrono::seconds(1);

  /// @param offset the wall clock minus the monotonic one, ns, at `now` of the monotonic one
  void set(std::int64_t offset, nanoseconds now) {
    if (known_ && std::abs(offset - offset_) >= kStep.count()) {
      former_ = offset_;
      stepped_at_ = now;
    }
    known_ = true;
    offset_ = offset;
  }
  bool agrees(std::int64_t offset) const { return known_ && std::abs(offset - offset_) < kStep.count(); }

  /// ns since 1970
  std::int64_t stamp_of(nanoseconds time) const { return time.count() + offset_; }
  /// How long before `now` somebody on this host has stamped so; negative: ahead of it. @pre stamp >= 0
  nanoseconds age_of(std::int64_t stamp, nanoseconds now) const {
    const std::int64_t age = stamp_of(now) - stamp;
    if (!former_ || now - stepped_at_ >= kRemembered) return nanoseconds(age);
    const std::int64_t by_former = now.count() + *former_ - stamp;
    return nanoseconds(std::abs(by_former) < std::abs(age) ? by_former : age);
  }

 private:
  std::int64_t offset_ = 0;
  bool known_ = false;
  std::optional<std::int64_t> former_;
  nanoseconds stepped_at_{0};
};

/// Converts instants of CLOCK_MONOTONIC to CLOCK_REALTIME. The difference of the two is measured once a second: packets
/// of one batch keep their distances. A quick look at each call finds a wall clock that was set.
class WallClock {
 public:
  using Steady = std::chrono::steady_clock;

  /// ns since 1970
  std::int64_t at(Steady::time_point when) {
    look(when);
    return offset_.stamp_of(when.time_since_epoch());
  }
  /// How long before `now` a stamp was given (WallOffset::age_of).
  std::chrono::nanoseconds age_of(std::int64_t stamp, Steady::time_point now) {
    look(now);
    return offset_.age_of(stamp, now.time_since_epoch());
  }

 private:
  static std::int64_t wall_now() {
    return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  }

  void look(Steady::time_point when) {
    const bool agrees = offset_.agrees(wall_now() - Steady::now().time_since_epoch().count());
    if (!agrees || when - measured_ >= std::chrono::seconds(1)) measure(when);
  }

  // The shortest of three readings counts: during that one the process was held up least.
  void measure(Steady::time_point when) {
    measured_ = when;
    auto shortest = Steady::duration::max();
    std::int64_t offset = 0;
    for (int i = 0; i < 3; ++i) {
      const auto before = Steady::now();
      const std::int64_t wall = wall_now();
      const auto took = Steady::now() - before;
      if (took >= shortest) continue;
      shortest = took;
      offset = wall - (before.time_since_epoch() + took / 2).count();
    }
    offset_.set(offset, when.time_since_epoch());
  }

  Steady::time_point measured_{-std::chrono::hours(1)};
  WallOffset offset_;
};

}  // namespace limb_ring::process
