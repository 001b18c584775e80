#include "tools/ringctl/ping_totals.h"

#include <algorithm>

#include "core/time.h"

namespace limb_ring::ringctl {

void PingTotals::add(const Result& result) {
  const std::uint64_t before = ended_[result.outcome]++;
  if (result.outcome != Outcome::delivered) return;
  least_ = std::min(least_, result.round_trip);
  most_ = std::max(most_, result.round_trip);
  if (kept_.size() < kKept)
    kept_.push_back(result.round_trip);
  else
    kept_[before % kKept] = result.round_trip;  // the oldest one's place
}

std::uint64_t PingTotals::with(Outcome outcome) const {
  const auto found = ended_.find(outcome);
  return found == ended_.end() ? 0 : found->second;
}

std::uint64_t PingTotals::ended() const {
  std::uint64_t all = 0;
  for (const auto& [outcome, count] : ended_) all += count;
  return all;
}

statistics::Percentiles PingTotals::round_trips() const {
  std::vector<core::Duration> samples(kept_.begin(), kept_.end());
  statistics::Percentiles trips = statistics::percentiles(samples);
  if (kept_.empty()) return trips;
  trips.min = statistics::microseconds(least_);
  trips.max = statistics::microseconds(most_);
  trips.samples = with(Outcome::delivered);
  return trips;
}

}  // namespace limb_ring::ringctl
