#pragma once

#include <cstdint>

#include "firmware/timestamps.h"

namespace limb_ring::firmware {

/// Something done at a fixed rate, by absolute deadlines: being late once delays nothing after
/// it. Deadlines missed altogether are left out and counted, never caught up in a burst.
class Periodic {
 public:
  /// First due one period after `start`. @pre rate_hz > 0
  Periodic(double rate_hz, nanoseconds start);

  nanoseconds due() const { return due_; }
  /// @return true once per deadline that has come
  bool take(nanoseconds now);
  std::uint64_t missed() const { return missed_; }

 private:
  nanoseconds period_;
  nanoseconds due_;
  std::uint64_t missed_ = 0;
};

}  // namespace limb_ring::firmware
