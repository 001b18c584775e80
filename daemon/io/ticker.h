#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <memory>

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

}  // namespace limb_ring::event_loop
