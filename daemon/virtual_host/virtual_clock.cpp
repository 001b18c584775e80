#include "virtual_host/virtual_clock.h"

namespace limb_ring::virtual_host {

using std::chrono::nanoseconds;

namespace {

/// What it has asked the ring for cannot be taken back: it then finds that it is another's turn, or that the timer is
/// gone.
class VirtualTimer final : public event_loop::Timer {
 public:
  VirtualTimer(sim::VirtualRing& ring, VirtualClock& clock, std::function<void()> on_time)
      : ring_(ring), clock_(clock), on_time_(std::move(on_time)) {}

  void expires_at(Time when) override {
    const std::uint64_t turn = ++*turn_;
    if (when == Time::max()) return;
    ring_.at(VirtualClock::ring_time(when), [this, turn, current = std::weak_ptr<std::uint64_t>(turn_)] {
      const auto alive = current.lock();
      if (!alive || *alive != turn) return;
      clock_.on_expired();
      const auto call = on_time_;  // it may destroy this
      call();
    });
  }
  void cancel() override { ++*turn_; }

 private:
  sim::VirtualRing& ring_;
  VirtualClock& clock_;
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
  return std::make_unique<VirtualTimer>(ring_, *this, std::move(on_time));
}

}  // namespace limb_ring::virtual_host
