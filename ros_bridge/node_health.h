#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <limb_ring/RingStatus.h>

#include <chrono>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "ros_bridge/line_health.h"

namespace limb_ring::bridge {

/// How long a warning of an event lasts.
constexpr std::chrono::seconds kWarnFor{5};

/// The condition of one node, for diagnostics. (ours)
///   STALE  nobody has heard of it, or there is nobody to ask
///   ERROR  it was heard and is not any more; alone; its id is a duplicate; its CPU has failed or is silent
///   WARN   it is up with something wrong, or something was wrong within kWarnFor
class NodeHealth {
 public:
  using Clock = std::chrono::steady_clock;

  NodeHealth(const config::NodeConfig& node, std::chrono::milliseconds beacon);

  /// To be given every status, in order.
  void take(const RingStatus& ring, Clock::time_point now);
  /// As of the status taken last.
  void tell(diagnostic_updater::DiagnosticStatusWrapper& out, Clock::time_point now);

 private:
  bool is_heard() const;
  void note_changes(const NodeStatus& now, Clock::time_point at);
  void tell_node(diagnostic_updater::DiagnosticStatusWrapper& out, Clock::time_point now) const;
  void tell_cpu(diagnostic_updater::DiagnosticStatusWrapper& out) const;
  void tell_values(diagnostic_updater::DiagnosticStatusWrapper& out) const;

  const config::NodeConfig& config_;
  double longest_silence_;  // s, of its beacons
  Recent recent_{kWarnFor};
  CounterGrowth errors_;
  NodeStatus status_;
  std::int32_t last_pid_ = 0;  // while it is down it has none
  std::vector<std::string> silent_sensors_;
  bool bridge_connected_ = false, has_silent_joints_ = false, was_heard_ = false;
  Clock::time_point heard_at_{};
};

/// The condition of the whole ring, in the words of `ringctl status`. (ours)
///   ERROR  the bridge has no connection to its daemon
///   WARN   not every node is up: an open chain, folded, or some are down; or a stop is latched
void tell_ring(const RingStatus& ring, diagnostic_updater::DiagnosticStatusWrapper& out);

/// The same for people, with the CPUs that are silent or have failed; empty if nothing is wrong.
std::string what_is_wrong(const std::vector<NodeStatus>& nodes);

}  // namespace limb_ring::bridge
