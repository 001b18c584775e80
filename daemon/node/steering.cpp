#include "node/steering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

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

namespace {

core::Duration scaled(nanoseconds real, double factor) {
  return core::Duration(static_cast<core::Int128>(static_cast<double>(real.count()) * factor * 1000));
}

}  // namespace

void Pace::set_factor(double factor, Real now, core::Time reached) {
  factor_ = factor;
  restart(now, reached);
}

void Pace::restart(Real now, core::Time reached) {
  real_ = now;
  virtual_ = reached;
}

core::Time Pace::allowed(Real now, core::Time reached) {
  if (std::isinf(factor_)) return core::kNever;
  const Real due = when(reached);
  if (now - due > kMostBehind) {
    lost_ += now - due - kMostBehind;
    real_ = now - kMostBehind;
    virtual_ = reached;
  }
  return virtual_ + scaled(now - real_, factor_);
}

nanoseconds Pace::late(Real now, core::Time reached) const {
  if (std::isinf(factor_)) return nanoseconds{0};
  return std::max(nanoseconds{0}, nanoseconds(now - when(reached)));
}

Pace::Real Pace::when(core::Time time) const {
  if (std::isinf(factor_)) return Real::min();
  constexpr double kLongest = 1e18;  // ns, 31 years
  const double ns = static_cast<double>((time - virtual_).count()) / 1000 / factor_;
  return real_ + nanoseconds(static_cast<std::int64_t>(std::min(std::ceil(ns), kLongest)));
}

namespace {

/// A call that the timer has asked the clock for cannot be cancelled. Instead, when it comes, it does nothing if the
/// timer was set again meanwhile or is gone.
class VirtualTimer final : public event_loop::Timer {
 public:
  VirtualTimer(VirtualClock& clock, const std::function<void()>& on_expired, std::function<void()> on_time)
      : clock_(clock), on_expired_(on_expired), on_time_(std::move(on_time)) {}

  void expires_at(Time when) override {
    const std::uint64_t turn = ++*turn_;
    if (when == Time::max()) return;
    clock_.call_at(VirtualClock::ring_time(when), [this, turn, current = std::weak_ptr<std::uint64_t>(turn_)] {
      const auto alive = current.lock();
      if (!alive || *alive != turn) return;
      on_expired_();
      const auto call = on_time_;  // it may destroy this
      call();
    });
  }
  void cancel() override { ++*turn_; }

 private:
  VirtualClock& clock_;
  const std::function<void()>& on_expired_;
  std::function<void()> on_time_;
  std::shared_ptr<std::uint64_t> turn_ = std::make_shared<std::uint64_t>(0);
};

}  // namespace

event_loop::NodeClock::Time VirtualClock::at(core::Time when) {
  const core::Duration since = when.time_since_epoch();
  if (since >= core::Duration(Time::max().time_since_epoch())) return Time::max();
  return Time(std::chrono::ceil<nanoseconds>(since));
}

event_loop::NodeClock::Time VirtualClock::now() const {
  return Time(std::chrono::floor<nanoseconds>(ring_.now().time_since_epoch()));
}

std::unique_ptr<event_loop::Timer> VirtualClock::timer(std::function<void()> on_time) {
  return std::make_unique<VirtualTimer>(*this, on_expired_, std::move(on_time));
}

void VirtualClock::call_at(core::Time when, std::function<void()> call) {
  ring_.at(when, [weak = std::weak_ptr<VirtualClock*>(self_), call = std::move(call)] {
    const auto self = weak.lock();
    if (self) (*self)->due(call);
  });
}

void VirtualClock::due(const std::function<void()>& call) {
  if (frozen_) return missed_.push_back(call);
  call();
}

void VirtualClock::thaw() {
  frozen_ = false;
  const std::weak_ptr<VirtualClock*> alive = self_;  // a call may destroy this
  for (const auto& call : std::exchange(missed_, {})) {
    if (alive.expired()) return;
    due(call);
  }
}

std::optional<std::string> Turnaround::on_attach(const host::ClientInfo& client) {
  const auto objection = calls_.on_attach(client);
  if (!objection && client.lockstep) late_.insert(client.id);
  return objection;
}

void Turnaround::on_detach(const host::ClientInfo& client) {
  late_.erase(client.id);  // its sends that have not entered the node yet are dropped
  calls_.on_detach(client);
}

/// When sends of the current turn enter the node: one instant for the whole turn, never before an earlier turn's.
core::Time Turnaround::entry() {
  if (std::exchange(turn_, ring_.now()) == ring_.now()) return entry_;
  const auto most = static_cast<std::uint64_t>(cpu_.jitter.count());
  const std::chrono::nanoseconds drawn(most == 0 ? 0 : random_() % (most + 1));
  return entry_ = std::max(entry_, ring_.now() + cpu_.turnaround + drawn);
}

template <class Call>
void Turnaround::later(host::ClientId client, Call call) {
  if (late_.count(client) == 0) return call();
  clock_.call_at(entry(), [this, client, call] {
    if (late_.count(client) != 0) call();
  });
}

void Turnaround::on_send(host::ClientId client, const client::SendRequest& request) {
  const std::vector<std::uint8_t> data(request.data.begin(), request.data.end());
  later(client, [this, client, request, data] {
    client::SendRequest own = request;
    own.data = {data.data(), data.size()};
    calls_.on_send(client, own);
  });
}

void Turnaround::on_interrupt(host::ClientId client, const client::InterruptRequest& request) {
  later(client, [this, client, request] { calls_.on_interrupt(client, request); });
}

void Turnaround::on_pull(host::ClientId client, const client::PullRequest& request) {
  later(client, [this, client, request] { calls_.on_pull(client, request); });
}

}  // namespace limb_ring::virtual_host
