#include "ros_bridge/periodic_calls.h"

#include <algorithm>
#include <utility>

namespace limb_ring::bridge {

void PeriodicCalls::add(Duration period, std::optional<Duration> phase, std::function<void()> call, Time now) {
  calls_.push_back({period, phase, std::move(call), {}});
  calls_.back().due = first_due(calls_.back(), now);
}

void PeriodicCalls::restart(Time now) {
  for (Call& call : calls_) call.due = first_due(call, now);
}

PeriodicCalls::Time PeriodicCalls::first_due(const Call& call, Time now) {
  if (!call.phase) return now + call.period;
  const Duration since = now.time_since_epoch() - *call.phase;
  const auto periods = since.count() < 0 ? 0 : since / call.period + 1;
  return Time(periods * call.period + *call.phase);
}

PeriodicCalls::Time PeriodicCalls::next_due() const {
  Time next = Time::max();
  for (const Call& call : calls_) next = std::min(next, call.due);
  return next;
}

void PeriodicCalls::run(Time now) {
  for (Call& call : calls_) {
    if (now < call.due) continue;
    call.call();
    do call.due += call.period;
    while (call.due <= now);
  }
}

}  // namespace limb_ring::bridge
