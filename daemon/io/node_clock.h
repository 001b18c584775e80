#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

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

}  // namespace limb_ring::event_loop
