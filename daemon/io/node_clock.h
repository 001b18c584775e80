#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "io/packet_loop.h"
#include "io/wall_clock.h"

namespace limb_ring::event_loop {

/// Calls back once, at an instant of a NodeClock. No call after its destruction.
class Timer {
 public:
  using Time = std::chrono::steady_clock::time_point;

  virtual ~Timer() = default;
  /// Replaces an earlier instant.
  virtual void expires_at(Time when) = 0;
  virtual void cancel() = 0;
};

/// The time that a node lives by: that of its machine, or of the virtual ring that it is a node of.
class NodeClock {
 public:
  using Time = Timer::Time;

  virtual ~NodeClock() = default;
  /// CLOCK_MONOTONIC, or since the virtual ring's start.
  virtual Time now() const = 0;
  /// ns since 1970 at that instant, for stamps; or since the virtual ring's start.
  virtual std::int64_t wall_ns(Time when) = 0;
  /// A timer that is exact even while packets pass; see packet_loop.h.
  virtual std::unique_ptr<Timer> timer(std::function<void()> on_time) = 0;
};

/// CLOCK_MONOTONIC, with timers of an event loop.
class MachineClock final : public NodeClock {
 public:
  explicit MachineClock(boost::asio::io_context& io) : io_(io) {}

  Time now() const override { return std::chrono::steady_clock::now(); }
  std::int64_t wall_ns(Time when) override { return wall_.at(when); }
  std::unique_ptr<Timer> timer(std::function<void()> on_time) override;

 private:
  boost::asio::io_context& io_;
  process::WallClock wall_;
};

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
