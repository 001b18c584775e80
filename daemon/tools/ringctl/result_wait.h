#pragma once

#include <chrono>

#include "limb_ring/host_port.h"

namespace limb_ring::ringctl {

/// How long the results of a node's sends are waited for. Every send ends by itself within the configured time-outs, so
/// only a daemon that is frozen, or a clock that stands, lets them wait for longer.
class ResultWait {
 public:
  explicit ResultWait(const HostPort& port) : port_(port) {}

  /// A result has come, or none is waited for.
  void restart() { begun_ = std::chrono::steady_clock::now(); }
  /// To be called now and then. @throw HostPortError that names the node, where it is in vain to go on
  void check() const;

 private:
  const HostPort& port_;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

}  // namespace limb_ring::ringctl
