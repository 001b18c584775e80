#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "io/signal_wait.h"
#include "tools/ringctl/ping_totals.h"
#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {

/// What `ringctl ping` was asked for.
struct PingOrder {
  NodeName to;
  std::uint64_t count = 0;                                     ///< 0: without end
  std::chrono::nanoseconds interval{std::chrono::seconds(1)};  ///< 0: the next as the last returns
  std::optional<std::chrono::nanoseconds> deadline;            ///< for all of it
  unsigned size = kMaxPayload;                                 ///< bytes of data
  std::uint8_t priority = 2;
};

/// Packets one after the other, each timed by the daemon: its first byte out to its matched return. Ends by
/// itself, as soon as somebody asks it to (Ctrl-C), or with the connection to the daemon.
/// @param each is told of every end, with the packet's number from 1.
class PingRun {
 public:
  using Each = std::function<void(std::uint64_t sequence, const Result&)>;
  PingRun(HostPort& port, const PingOrder& order, Each each) : port_(port), order_(order), each_(std::move(each)) {}

  PingTotals run();

 private:
  bool over() const;
  void send_one();
  void look_for_the_end();
  void wait_for_result(std::uint32_t token);
  void wait_for_turn(std::uint64_t number);
  bool asked_to_end(std::chrono::milliseconds patience);

  HostPort& port_;
  const PingOrder& order_;
  Each each_;
  process::SignalWait signals_;
  bool asked_to_end_ = false;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  process::Standstill standstill_{begun_};
  PingTotals totals_;
};

}  // namespace limb_ring::ringctl
