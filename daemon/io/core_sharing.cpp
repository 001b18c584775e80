#include "io/core_sharing.h"

#include <sched.h>

#include <algorithm>
#include <utility>

namespace limb_ring::event_loop {

bool YieldTimes::due(Time now, bool often) {
  if (!alone(now)) return false;
  const std::int64_t period = now.time_since_epoch() / kPeriod;
  const bool first = std::exchange(period_, period) != period;
  if (first) last_useful_ = now;
  if (!often) return first;
  return now - last_useful_ < kPatience && now.time_since_epoch() % kPeriod >= kSleepFor;
}

void YieldTimes::came_back(Time from, Time to) {
  if (to - from <= kLongestRound) return;
  const bool again = from - pause_ends_ < pause_;  // the last pause was not long ago
  pause_ = again ? std::min(2 * pause_, kLongestPause) : kFirstPause;
  pause_ends_ = to + pause_;
}

void CoreSharing::begin() {
  cpu_set_t cores;
  one_core_ = ::sched_getaffinity(0, sizeof cores, &cores) == 0 && CPU_COUNT(&cores) == 1;
  ours_ = ::sched_getscheduler(0) == SCHED_OTHER;
}

void CoreSharing::end() {
  be_batch(false);
  have_run_ = false;
}

void CoreSharing::let_others_run(YieldTimes::Time now, bool answer_due) {
  be_batch(times_.alone(now));
  if (!times_.due(now, one_core_ && !answer_due)) return;
  ::sched_yield();
  times_.came_back(now, std::chrono::steady_clock::now());
  have_run_ = true;
}

void CoreSharing::after_turn(YieldTimes::Time now, bool any) {
  if (std::exchange(have_run_, false) && any) times_.was_useful(now);
}

// If it is refused, the daemon stays an ordinary one, and is interrupted by those it wakes.
void CoreSharing::be_batch(bool batch) {
  if (!ours_ || batch == batch_) return;
  batch_ = batch;
  const sched_param ordinary{};
  ::sched_setscheduler(0, batch ? SCHED_BATCH : SCHED_OTHER, &ordinary);
}

}  // namespace limb_ring::event_loop
