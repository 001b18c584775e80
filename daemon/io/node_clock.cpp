#include "io/node_clock.h"

#include <algorithm>

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

boost::asio::execution_context::id SharedTimers::id;

void SharedTimer::add(std::shared_ptr<Ticker::State> ticker) {
  tickers_.push_back(std::move(ticker));
  if (timer_) return;
  timer_.emplace(io_, [this] { tick(); });
  timer_->expires_at(next_tick(Ticker::Time::clock::now(), period_));
}

// A call may begin and stop tickers.
void SharedTimer::tick() {
  ticking_ = true;
  const auto now = Ticker::Time::clock::now();
  for (std::size_t i = 0; i < tickers_.size(); ++i) {
    const auto ticker = tickers_[i];
    if (!ticker->stopped) ticker->on_tick(now);
  }
  ticking_ = false;
  forget_stopped();
  if (timer_) timer_->expires_at(next_tick(now, period_));
}

void SharedTimer::forget_stopped() {
  if (ticking_) return;
  tickers_.erase(std::remove_if(tickers_.begin(), tickers_.end(), [](const auto& ticker) { return ticker->stopped; }),
                 tickers_.end());
  if (tickers_.empty()) timer_.reset();
}

Ticker::Ticker(boost::asio::io_context& io, std::chrono::milliseconds period, std::function<void(Time)> on_tick)
    : state_(std::make_shared<State>()), timer_(boost::asio::use_service<SharedTimers>(io).of(period)) {
  state_->on_tick = std::move(on_tick);
  timer_->add(state_);
}

void Ticker::stop() {
  if (std::exchange(state_->stopped, true)) return;
  timer_->forget_stopped();
}

}  // namespace limb_ring::event_loop
