#pragma once

#include <limb_ring/RingStatus.h>
#include <ros/time.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>

namespace limb_ring::bench {

/// How long packets were under way, in microseconds.
struct RoundTrip {
  double p50 = 0, p99 = 0, max = 0;
};

/// What one case has given: of one node, of all nodes that sent, or of several rounds.
struct Measurement {
  RoundTrip round_trip_us;
  double packets_per_second = 0;  ///< of all senders together
  std::uint64_t packets = 0;      ///< that came back
  std::uint64_t failed = 0;       ///< that did not, or were not taken
};

double median(std::vector<double> values);

/// Several senders at the same time: median of their medians, the worst p99 and maximum, rates
/// and counts added up.
Measurement together(const std::vector<Measurement>& senders);
/// The same case several times: medians of the rounds, the worst maximum, counts added up.
Measurement of_rounds(const std::vector<Measurement>& rounds);

/// Round trips of one sender, one after the other, for so long.
class Samples {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Samples(double seconds);
  void begin(Clock::time_point now) { begun_ = last_ = now; }
  /// A packet is back, and the next one goes. @return false once the time is over
  bool lap(Clock::time_point now);
  Measurement measurement();

 private:
  Clock::duration duration_;
  Clock::time_point begun_, last_;
  std::vector<Clock::duration> laps_;
};

/// From one ring_status to another, each what the ring's nodes knew in that instant: how long that is, and what they
/// counted meanwhile.
class StatusSpan {
 public:
  /// @param seconds it is so long at least
  explicit StatusSpan(double seconds) : seconds_(seconds) {}

  void take(const RingStatus& status, ros::WallTime now) {
    if (done()) return;
    last_ = counts_of(status);
    if (!begun()) {
      begun_ = now;
      first_ = last_;
    }
    ended_ = now;
  }

  bool begun() const { return !begun_.isZero(); }
  bool done() const { return begun() && seconds() >= seconds_; }
  double seconds() const { return (ended_ - begun_).toSec(); }
  /// Joint states that the nodes' CPUs sent, and of those the ones that did not come.
  std::uint64_t samples() const { return last_.received - first_.received + left_out(); }
  std::uint64_t left_out() const { return last_.missing - first_.missing; }
  /// Commands that each node with joints has taken, on average.
  double commands_each() const {
    if (last_.nodes == 0) return 0;
    return static_cast<double>(last_.commands - first_.commands) / static_cast<double>(last_.nodes);
  }
  /// s, at the end, of the node for which it is worst
  double lap_p50() const { return last_.lap_p50; }
  double lap_p99() const { return last_.lap_p99; }

 private:
  struct Counts {
    std::uint64_t received = 0, missing = 0;
    std::uint64_t commands = 0, nodes = 0;
    double lap_p50 = 0, lap_p99 = 0;
  };

  static Counts counts_of(const RingStatus& status) {
    Counts counts;
    for (std::size_t i = 0; i < status.counter_names.size(); ++i)
      if (status.counter_names[i] == "commands_delivered") counts.commands = status.counter_values[i];
    for (const auto& node : status.nodes) {
      counts.nodes += node.states_received != 0;
      counts.received += node.states_received;
      counts.missing += node.states_missing;
      counts.lap_p50 = std::max(counts.lap_p50, node.round_trip_p50);
      counts.lap_p99 = std::max(counts.lap_p99, node.round_trip_p99);
    }
    return counts;
  }

  double seconds_;
  ros::WallTime begun_, ended_;
  Counts first_, last_;
};

}  // namespace limb_ring::bench
