#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "io/packet_loop.h"

namespace limb_ring::event_loop {

class SharedTimer;

/// Calls from the event loop once per period. All tickers of an event loop that have the same period share one timer,
/// and so the phase: the process wakes up once for all of them. It does at multiples of the period on the steady clock,
/// so that all processes of a host wake at once. The first call may come before a whole period is over. No call after
/// stop() or destruction, also from within a call.
class Ticker {
 public:
  using Time = std::chrono::steady_clock::time_point;

  Ticker(boost::asio::io_context& io, std::chrono::milliseconds period, std::function<void(Time)> on_tick);
  ~Ticker() { stop(); }
  Ticker(const Ticker&) = delete;
  Ticker& operator=(const Ticker&) = delete;
  void stop();

 private:
  friend class SharedTimer;
  struct State {
    std::function<void(Time)> on_tick;
    bool stopped = false;
  };
  std::shared_ptr<State> state_;
  std::shared_ptr<SharedTimer> timer_;
};

/// The first multiple of `period` on the steady clock behind `now`.
constexpr Ticker::Time next_tick(Ticker::Time now, std::chrono::milliseconds period) {
  return now + period - now.time_since_epoch() % period;
}

/// The one timer of all tickers of one period.
class SharedTimer {
 public:
  SharedTimer(boost::asio::io_context& io, std::chrono::milliseconds period) : io_(io), period_(period) {}

  void add(std::shared_ptr<Ticker::State> ticker);
  /// Removes the tickers that have stopped; without any left the timer stops, too.
  void forget_stopped();

 private:
  void tick();

  boost::asio::io_context& io_;
  std::optional<PacketTimer> timer_;  ///< while there are tickers
  std::chrono::milliseconds period_;
  std::vector<std::shared_ptr<Ticker::State>> tickers_;
  bool ticking_ = false;
};

/// The shared timers of an io_context, by period.
class SharedTimers final : public boost::asio::execution_context::service {
 public:
  static boost::asio::execution_context::id id;
  explicit SharedTimers(boost::asio::execution_context& io)
      : service(io), io_(static_cast<boost::asio::io_context&>(io)) {}

  std::shared_ptr<SharedTimer> of(std::chrono::milliseconds period) {
    auto& timer = timers_[period];
    if (!timer) timer = std::make_shared<SharedTimer>(io_, period);
    return timer;
  }

 private:
  void shutdown() override { timers_.clear(); }

  boost::asio::io_context& io_;
  std::map<std::chrono::milliseconds, std::shared_ptr<SharedTimer>> timers_;
};

}  // namespace limb_ring::event_loop
