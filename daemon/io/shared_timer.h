#pragma once

#include <boost/asio/io_context.hpp>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "io/packet_timer.h"
#include "io/ticker.h"

namespace limb_ring::event_loop {

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
