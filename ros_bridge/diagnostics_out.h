#pragma once

#include <deque>

#include "ros_bridge/bridge_losses.h"
#include "ros_bridge/line_health.h"
#include "ros_bridge/node_health.h"
#include "ros_bridge/promises_out.h"
#include "ros_bridge/stamped_updater.h"

namespace limb_ring::bridge {

/// `/diagnostics`: the ring, every node and every line of it, as `limb_ring: NAME` (behind the
/// namespace, where there is one); hardware id: the ring's name. One thread.
class DiagnosticsOut {
 public:
  DiagnosticsOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const Counters& counters,
                 const RosClock& clock);

  /// From now on "promises" is told as well; they must outlive this. Before the first take().
  void add(const PromisesOut& promises);
  /// Publishes what the status says, together with what was wrong lately.
  void take(const RingStatus& status);

 private:
  void tell_bridge(diagnostic_updater::DiagnosticStatusWrapper& out);

  const Counters& counters_;
  RingStatus status_;
  BridgeLosses losses_;
  std::deque<NodeHealth> nodes_;  // a deque: the updater's tasks hold on to them
  std::deque<LineHealth> lines_;
  StampedUpdater updater_;
};

}  // namespace limb_ring::bridge
