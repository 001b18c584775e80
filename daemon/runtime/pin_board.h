#pragma once

#include <array>
#include <cstdint>

#include "config/ring_config.h"
#include "runtime/cpu_socket.h"

namespace limb_ring::runtime {

/// The last latch of this node's clock by a sync pin. Not wire::ClockLatch: a beacon's count has 32 bits and wraps.
struct ClockLatch {
  std::uint64_t count = 0;  ///< latches so far; 0: none yet
  std::uint8_t source = 0;
  std::int64_t clock_ns = 0;  ///< CLOCK_MONOTONIC
};

/// What the interrupt pins of this node drive. (paper: pins; the actions are ours)
class PinBoard {
 public:
  PinBoard(const std::array<config::PinConfig, 8>& pins, CpuSocket& cpu) : pins_(pins), cpu_(cpu) {}

  /// Pin `factor` was pulled by node `source`; `clock_ns` is when.
  /// @return what was done, for people
  std::string pull(std::uint8_t factor, std::uint8_t source, std::int64_t clock_ns);
  /// Known here at once, to the other nodes by the next beacon.
  void latch(std::uint8_t source, std::int64_t clock_ns);
  const ClockLatch& last_latch() const { return latch_; }

 private:
  const std::array<config::PinConfig, 8>& pins_;
  CpuSocket& cpu_;
  ClockLatch latch_;
};

}  // namespace limb_ring::runtime
