#pragma once

#include <cstdint>

#include "config/ring_config.h"
#include "node/cpu_socket.h"

namespace limb_ring::runtime {

/// What the interrupt pins of this node drive. (paper: pins; the actions are ours)
class PinBoard {
 public:
  PinBoard(const config::Pins& pins, CpuSocket& cpu) : pins_(pins), cpu_(cpu) {}

  /// Pin `factor` was pulled by node `source`; `clock_ns` is when.
  /// @return what was done, for people
  std::string pull(std::uint8_t factor, std::uint8_t source, std::int64_t clock_ns);
  /// By a sync pin. Known here at once, to the other nodes by the next beacon.
  void latch(std::uint8_t source, std::int64_t clock_ns);
  const wire::ClockLatch& last_latch() const { return latch_; }

 private:
  const config::Pins& pins_;
  CpuSocket& cpu_;
  wire::ClockLatch latch_;  ///< the last one
};

}  // namespace limb_ring::runtime
