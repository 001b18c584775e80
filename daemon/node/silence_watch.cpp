#include "node/silence_watch.h"

#include <utility>

#include "config/ring_config.h"

namespace limb_ring::runtime {

SilenceWatch::SilenceWatch(event_loop::NodeClock& clock, std::function<void()> on_silent)
    : clock_(clock), on_silent_(std::move(on_silent)), timer_(clock.timer([this] { time_over(); })) {}

void SilenceWatch::begin(milliseconds alive_period) {
  timer_->cancel();
  alive_period_ = alive_period;
  spoke_ = clock_.now();
  silent_ = false;
  watch();
}

bool SilenceWatch::spoke(Time now) {
  spoke_ = now;
  if (!std::exchange(silent_, false)) return false;
  watch();
  return true;
}

SilenceWatch::Time SilenceWatch::silent_at() const {
  return spoke_ + config::CpuConfig::kSilentPeriods * alive_period_;
}

void SilenceWatch::watch() {
  if (alive_period_.count() > 0) watch_until(silent_at());
}

void SilenceWatch::watch_until(Time when) {
  over_at_ = when;
  timer_->expires_at(when);
}

void SilenceWatch::time_over() {
  const Time now = clock_.now();
  if (now < silent_at()) return watch();  // it spoke meanwhile
  // If this daemon itself was not scheduled in time, the CPU perhaps was not either: give it another period.
  const bool late = now - over_at_ > alive_period_ / 4;
  if (late) return watch_until(now + alive_period_);
  silent_ = true;
  on_silent_();
}

}  // namespace limb_ring::runtime
