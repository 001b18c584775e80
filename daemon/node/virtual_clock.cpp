#include "node/virtual_clock.h"

namespace limb_ring::virtual_host {

using std::chrono::nanoseconds;

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

}  // namespace limb_ring::virtual_host
