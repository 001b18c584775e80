#pragma once

#include <boost/asio/io_context.hpp>

#include "io/node_clock.h"
#include "io/wall_clock.h"

namespace limb_ring::event_loop {

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

}  // namespace limb_ring::event_loop
