#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "client/timestamps.h"

namespace limb_ring::firmware {

/// Something done at a fixed rate, at the multiples of its period on the clock. So all CPUs of a host sample in the
/// same instant, as the CPUs of a robot do by a sync interrupt, and their packets travel together. A process that was
/// not scheduled makes up for the last kMadeUp deadlines, or those of the last kMadeUpFor if these are more, since the
/// timer of a real CPU would have met them; earlier ones are left out and counted.
class Periodic {
 public:
  static constexpr std::int64_t kMadeUp = 8;
  static constexpr std::chrono::milliseconds kMadeUpFor{32};  ///< a desktop pauses a process for so long
  /// A deadline that has come.
  struct Due {
    nanoseconds at;
    std::uint64_t left_out;  ///< deadlines before this one that were not made up for
  };

  /// First due at the first multiple of the period behind `start`. @pre rate_hz > 0
  Periodic(double rate_hz, nanoseconds start)
      : period_(static_cast<std::int64_t>(1e9 / rate_hz)), due_((start / period_ + 1) * period_) {}

  nanoseconds due() const { return due_; }
  /// @return once per deadline that has come, in order
  std::optional<Due> take(nanoseconds now) {
    if (now < due_) return std::nullopt;
    const std::int64_t left_out = std::max<std::int64_t>(0, (now - due_) / period_ + 1 - made_up());
    const Due due{due_ + left_out * period_, static_cast<std::uint64_t>(left_out)};
    left_out_ += due.left_out;
    due_ = due.at + period_;
    return due;
  }
  std::uint64_t left_out() const { return left_out_; }

 private:
  std::int64_t made_up() const { return std::max<std::int64_t>(kMadeUp, kMadeUpFor / period_); }

  nanoseconds period_;
  nanoseconds due_;
  std::uint64_t left_out_ = 0;
};

}  // namespace limb_ring::firmware
