#pragma once

#include <cstdint>

#include "firmware/timestamps.h"

namespace limb_ring::firmware {

/// Something done at a fixed rate, by absolute deadlines: being late once delays nothing after
/// it. Deadlines missed altogether are left out and counted, never caught up in a burst.
class Periodic {
 public:
  /// First due one period after `start`. @pre rate_hz > 0
  Periodic(double rate_hz, nanoseconds start)
      : period_(static_cast<std::int64_t>(1e9 / rate_hz)), due_(start + period_) {}

  nanoseconds due() const { return due_; }
  /// @return true once per deadline that has come
  bool take(nanoseconds now) {
    if (now < due_) return false;
    const std::int64_t late = (now - due_) / period_;
    missed_ += static_cast<std::uint64_t>(late);
    due_ += period_ * (late + 1);
    return true;
  }
  std::uint64_t missed() const { return missed_; }

 private:
  nanoseconds period_;
  nanoseconds due_;
  std::uint64_t missed_ = 0;
};

}  // namespace limb_ring::firmware
