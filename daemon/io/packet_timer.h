#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>

#include "io/unique_fd.h"
#include "io/watch.h"

namespace limb_ring::event_loop {

/// A timer that is exact while packets pass too, when Asio's may be PacketLoop::kColdPeriod late.
class PacketTimer {
 public:
  /// @throw std::system_error
  PacketTimer(boost::asio::io_context& io, std::function<void()> on_time);

  /// Calls back once, at `when`; replaces an earlier instant.
  void expires_at(std::chrono::steady_clock::time_point when);
  void cancel();

 private:
  process::UniqueFd timer_;
  Watch watch_;
};

}  // namespace limb_ring::event_loop
