#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/signal_wait.h"
#include "judge/percentiles.h"
#include "limb_ring/host_port.h"
#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {

/// How all the packets of a ping ended. Takes no more memory the longer it goes on.
class PingTotals {
 public:
  /// Round trips for p50 and p99: those of the last packets, as many as a count can be.
  static constexpr std::size_t kKept = 1'000'000;

  std::uint64_t sent = 0;
  std::chrono::nanoseconds took{0};
  std::string problem;  ///< why there was an early end: the daemon has gone. Empty: there was none

  void add(const Result& result);
  std::uint64_t with(Outcome outcome) const;
  std::uint64_t ended() const;
  /// Of the delivered ones: all, but for p50 and p99.
  statistics::Percentiles round_trips() const;
  /// Of the last kKept that were delivered.
  const std::vector<std::chrono::nanoseconds>& kept() const { return kept_; }
  bool all_are_kept() const { return with(Outcome::delivered) <= kKept; }

 private:
  std::map<Outcome, std::uint64_t> ended_;
  std::vector<std::chrono::nanoseconds> kept_;
  std::chrono::nanoseconds least_ = std::chrono::nanoseconds::max(), most_{0};
};

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

/// "512 bytes to left_knee (10): seq=1 time=61.2 us", or how else it ended.
std::string ping_line(const PingOrder& order, std::uint64_t sequence, const Result& result);
/// The statistics at the end, for people ...
std::string ping_text(const PingOrder& order, const PingTotals& totals);
/// ... and for programs.
nlohmann::json ping_json(const PingOrder& order, const PingTotals& totals);

}  // namespace limb_ring::ringctl
