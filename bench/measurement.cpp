#include "bench/measurement.h"

#include <algorithm>

#include "core/time.h"
#include "judge/percentiles.h"

namespace limb_ring::bench {
namespace {

template <typename Get>
std::vector<double> each(const std::vector<Measurement>& all, Get get) {
  std::vector<double> values;
  for (const Measurement& one : all) values.push_back(get(one));
  return values;
}

double worst(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

Measurement counts_of(const std::vector<Measurement>& all) {
  Measurement sum;
  for (const Measurement& one : all) {
    sum.packets += one.packets;
    sum.failed += one.failed;
    sum.packets_per_second += one.packets_per_second;
  }
  return sum;
}

double p50(const Measurement& one) { return one.round_trip_us.p50; }
double p99(const Measurement& one) { return one.round_trip_us.p99; }
double longest(const Measurement& one) { return one.round_trip_us.max; }
double rate(const Measurement& one) { return one.packets_per_second; }

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

Measurement together(const std::vector<Measurement>& senders) {
  Measurement all = counts_of(senders);
  all.round_trip_us = {median(each(senders, p50)), worst(each(senders, p99)), worst(each(senders, longest))};
  return all;
}

Measurement of_rounds(const std::vector<Measurement>& rounds) {
  Measurement all = counts_of(rounds);
  all.round_trip_us = {median(each(rounds, p50)), median(each(rounds, p99)), worst(each(rounds, longest))};
  all.packets_per_second = median(each(rounds, rate));
  return all;
}

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
