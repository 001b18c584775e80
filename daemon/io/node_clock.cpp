#include "io/node_clock.h"

#include "io/packet_loop.h"

namespace limb_ring::event_loop {
namespace {

/// Does not call back if it was set again or cancelled in the turn in which it ran out.
class MachineTimer final : public Timer {
 public:
  MachineTimer(boost::asio::io_context& io, std::function<void()> on_time)
      : on_time_(std::move(on_time)), timer_(io, [this] { expired(); }) {}

  void expires_at(Time when) override {
    when_ = when;
    timer_.expires_at(when);
  }
  void cancel() override {
    when_ = kNever;
    timer_.cancel();
  }

 private:
  static constexpr Time kNever = Time::max();

  void expired() {
    if (when_ == kNever || std::chrono::steady_clock::now() < when_) return;
    when_ = kNever;
    const auto call = on_time_;  // it may destroy this
    call();
  }

  std::function<void()> on_time_;
  Time when_ = kNever;
  PacketTimer timer_;
};

}  // namespace

std::unique_ptr<Timer> MachineClock::timer(std::function<void()> on_time) {
  return std::make_unique<MachineTimer>(io_, std::move(on_time));
}

}  // namespace limb_ring::event_loop
