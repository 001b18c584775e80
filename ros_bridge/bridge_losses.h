#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <chrono>

#include "ros_bridge/counters.h"
#include "ros_bridge/recent.h"

namespace limb_ring::bridge {

/// What the bridge itself loses, for diagnostics: a warning for kWarnFor of each of its losses that has grown. (ours)
class BridgeLosses {
 public:
  using Clock = std::chrono::steady_clock;

  BridgeLosses();

  void take(const Counters::Values& losses, Clock::time_point now);
  /// To be called behind what else the summary says.
  void tell(diagnostic_updater::DiagnosticStatusWrapper& out, Clock::time_point now);

 private:
  Counters::Values last_;
  Recent recent_;
};

}  // namespace limb_ring::bridge
