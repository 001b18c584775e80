#pragma once

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

}  // namespace limb_ring::bench
