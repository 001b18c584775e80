#include "ros_bridge/diagnostics_out.h"

#include "ros_bridge/ring_health.h"

namespace limb_ring::bridge {
namespace {

using diagnostic_updater::DiagnosticStatusWrapper;
using Clock = std::chrono::steady_clock;

std::string prefix_in(const ros::NodeHandle& nodes) { return nodes.resolveName("limb_ring").substr(1); }

}  // namespace

DiagnosticsOut::DiagnosticsOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const Counters& counters,
                               const RosClock& clock)
    : counters_(counters), updater_(nodes, prefix_in(nodes), ring.ring, clock) {
  updater_.add("ring", [this](DiagnosticStatusWrapper& out) { tell_bridge(out); });
  for (std::size_t i = 0; i < ring.nodes.size(); ++i) {
    NodeHealth& node = nodes_.emplace_back(ring.nodes[i], ring.timeouts.beacon);
    updater_.add(ring.nodes[i].name, [&node](DiagnosticStatusWrapper& out) { node.tell(out, Clock::now()); });
    LineHealth& line = lines_.emplace_back(ring.nodes[i], ring.nodes[(i + 1) % ring.nodes.size()]);
    updater_.add(line.name(), [&line](DiagnosticStatusWrapper& out) { line.tell(out, Clock::now()); });
  }
}

void DiagnosticsOut::add(const PromisesOut& promises) {
  updater_.add("promises", [&promises](DiagnosticStatusWrapper& out) { promises.tell(out); });
}

void DiagnosticsOut::take(const RingStatus& status) {
  status_ = status;
  losses_.take(counters_.losses(), Clock::now());
  for (NodeHealth& node : nodes_) node.take(status, Clock::now());
  for (LineHealth& line : lines_) line.take(status, Clock::now());
  updater_.update();
}

void DiagnosticsOut::tell_bridge(DiagnosticStatusWrapper& out) {
  tell_ring(status_, out);
  losses_.tell(out, Clock::now());
  out.add("ring", status_.ring);
  out.add("bridge at node", status_.node);
  out.add("ring size", status_.ring_size);
  for (std::size_t i = 0; i < status_.counter_names.size(); ++i)
    out.add(status_.counter_names[i], status_.counter_values[i]);
}

}  // namespace limb_ring::bridge
