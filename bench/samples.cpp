#include "bench/samples.h"

#include "core/time.h"
#include "judge/percentiles.h"

namespace limb_ring::bench {
namespace {

constexpr std::size_t kMostLaps = 1'000'000;

}  // namespace

Samples::Samples(double seconds)
    : duration_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds))) {
  laps_.reserve(kMostLaps);
}

bool Samples::lap(Clock::time_point now) {
  laps_.push_back(now - last_);
  last_ = now;
  return now - begun_ < duration_ && laps_.size() < kMostLaps;
}

Measurement Samples::measurement() {
  std::vector<core::Duration> durations(laps_.begin(), laps_.end());
  const statistics::Percentiles p = statistics::percentiles(durations);
  Measurement result;
  result.round_trip_us = {p.p50, p.p99, p.max};
  result.packets = laps_.size();
  const double seconds = std::chrono::duration<double>(last_ - begun_).count();
  if (seconds > 0) result.packets_per_second = static_cast<double>(laps_.size()) / seconds;
  return result;
}

}  // namespace limb_ring::bench
