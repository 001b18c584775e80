#include "node/steering.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace limb_ring::virtual_host {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

runtime::ClockControl::State Steering::state() const {
  State state;
  state.now = std::chrono::floor<nanoseconds>(ring_.now().time_since_epoch());
  state.pace = pace_ ? pace_->factor() : std::numeric_limits<double>::infinity();
  state.paused = pause_at_ <= ring_.now();
  if (pace_ && !state.paused) state.late = pace_->late(steady_clock::now(), ring_.now());
  if (pace_) state.lost = pace_->lost();
  state.follows = follows_;
  state.allowed = std::chrono::floor<nanoseconds>(allowed_.time_since_epoch());
  state.outer_zero = outer_zero_;
  return state;
}

void Steering::set_pace(double factor) {
  if (pace_) pace_->set_factor(factor, steady_clock::now(), ring_.now());
}

void Steering::pause() {
  pause_at_ = ring_.now();
  end_steps();
}

void Steering::run() {
  pause_at_ = core::kNever;
  end_steps();
}

void Steering::step(nanoseconds time, std::function<void()> done) {
  end_steps();
  pause_at_ = ring_.now() + time;
  steps_.push_back(std::move(done));
}

bool Steering::allow(nanoseconds until, nanoseconds outer_zero) {
  allowed_ = core::Time{} + until;
  outer_zero_ = outer_zero;
  return follows_;
}

core::Time Steering::limit() const { return follows_ ? std::min(pause_at_, allowed_) : pause_at_; }

// The pace restarts, so that the ring does not catch up for the time that it stood.
bool Steering::holds() {
  if (ring_.now() < limit()) return false;
  if (pace_) pace_->restart(steady_clock::now(), ring_.now());
  if (ring_.now() >= pause_at_) end_steps();
  return true;
}

void Steering::end_steps() {
  for (const auto& done : std::exchange(steps_, {})) done();
}

}  // namespace limb_ring::virtual_host
