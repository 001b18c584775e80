#pragma once

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

}  // namespace limb_ring::bench
