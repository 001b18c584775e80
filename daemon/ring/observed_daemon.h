#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "limb_ring/host_port.h"

namespace limb_ring::live {

/// The observations (`observe`) of one node's daemon, which may die, stop and come back. (ours)
class ObservedDaemon {
 public:
  /// @param node its id
  /// @param what is to be observed, in JSON
  /// @param runtime as ConnectOptions
  ObservedDaemon(const std::string& ring, std::uint8_t node, std::string what, const std::string& runtime = {});

  bool connected() const { return port_.has_value(); }
  /// Tries to connect, at most four times a second, and waits 200 ms for a daemon that is starting, and 200 ms for its
  /// answer. @return true if connected now
  bool look_for();
  /// There is one, perhaps stopped, or that cannot be known.
  bool may_live() const;
  /// Why a daemon that lives, or may, could not be connected to when it was looked for last; empty where it could.
  const std::string& problem() const { return problem_; }
  /// The next observation. @return nothing if none is waiting, or the daemon is gone
  std::optional<std::string> next();
  /// Drops the connection; look_for() makes a new one.
  void drop() { port_.reset(); }
  /// From its clock to dates since 1970. @pre connected()
  std::chrono::nanoseconds to_date() const {
    const std::chrono::nanoseconds now = port_->now();
    return port_->stamp_of(now) - now;
  }

 private:
  using Clock = std::chrono::steady_clock;

  ConnectOptions daemon_;
  std::string folder_;
  std::uint8_t node_;
  std::string what_;
  std::optional<HostPort> port_;
  Clock::time_point next_try_{};
  std::string problem_;
};

}  // namespace limb_ring::live
