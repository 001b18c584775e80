#include "ros_bridge/ring_health.h"

#include <algorithm>
#include <string>

#include "ask/ring_words.h"

namespace limb_ring::bridge {
namespace {

using Level = diagnostic_msgs::DiagnosticStatus;
using Nodes = std::vector<NodeStatus>;

std::string name_of(const Nodes& nodes, int id) {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [id](const NodeStatus& node) { return node.id == id; });
  return found != nodes.end() ? found->name : std::to_string(id);
}

/// "A -> B"; empty where nobody knows of one.
std::string broken_line(const Nodes& nodes) {
  for (const NodeStatus& node : nodes)
    if (node.broken_before >= 0 && node.broken_behind >= 0)
      return name_of(nodes, node.broken_before) + " -> " + name_of(nodes, node.broken_behind);
  return "";
}

std::string in_words(const Nodes& nodes) {
  std::vector<ask::NodeInRing> all;
  for (const NodeStatus& node : nodes) all.push_back({node.state, node.ring_size});
  return ask::ring_in_words(all, broken_line(nodes));
}

}  // namespace

void tell_ring(const RingStatus& ring, diagnostic_updater::DiagnosticStatusWrapper& out) {
  const Nodes& nodes = ring.nodes;
  const bool well = std::all_of(nodes.begin(), nodes.end(), [](const NodeStatus& node) { return node.state == "up"; });
  if (ring.connected)
    out.summary(well ? Level::OK : Level::WARN, in_words(nodes));
  else
    out.summary(Level::ERROR, ring.message);
  const auto stopped = std::count_if(nodes.begin(), nodes.end(), [](const NodeStatus& node) { return node.stopped; });
  if (stopped > 0) out.mergeSummary(Level::WARN, std::to_string(stopped) + " stopped until `resume`");
}

}  // namespace limb_ring::bridge
