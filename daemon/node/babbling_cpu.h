#pragma once

#include <array>

#include "node/node_driver.h"

namespace limb_ring::runtime {

/// Sends as a babbling CPU would (a "babbling idiot"): the largest packets, to all, at the highest priority, without
/// end. The real CPU goes on beside it. (ours)
class BabblingCpu {
 public:
  explicit BabblingCpu(NodeDriver& driver) : driver_(driver), next_(driver.clock().timer([this] { send_next(); })) {}

  /// One packet per `period`, as each has ended; 0: its queue is always full, and what is beyond that is rejected.
  void start(std::chrono::nanoseconds period);
  void stop();
  /// Packets that have ended, in whatever way, since start().
  std::uint64_t sent() const { return sent_; }

  void on_ended(const core::SendEnded& ended);

 private:
  void send();
  void send_next();

  NodeDriver& driver_;
  std::unique_ptr<event_loop::Timer> next_;
  std::chrono::nanoseconds period_{0};
  bool on_ = false;
  std::uint32_t next_token_ = 1;   ///< each send has its own, by which `ringctl judge` tells them apart
  std::uint32_t first_token_ = 1;  ///< of this run: results of an earlier one do not count
  std::uint64_t sent_ = 0;
  std::array<std::uint8_t, wire::kMaxPayload> data_{};
};

}  // namespace limb_ring::runtime
