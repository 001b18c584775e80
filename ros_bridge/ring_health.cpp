#include "ros_bridge/ring_health.h"

#include <algorithm>
#include <string>

namespace limb_ring::bridge {
namespace {

using Level = diagnostic_msgs::DiagnosticStatus;
using Nodes = std::vector<NodeStatus>;

std::size_t in_state(const Nodes& nodes, const char* state) {
  return static_cast<std::size_t>(
      std::count_if(nodes.begin(), nodes.end(), [state](const NodeStatus& node) { return node.state == state; }));
}

std::string name_of(const Nodes& nodes, int id) {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [id](const NodeStatus& node) { return node.id == id; });
  return found != nodes.end() ? found->name : std::to_string(id);
}

std::string broken_line(const Nodes& nodes) {
  for (const NodeStatus& node : nodes)
    if (node.broken_before >= 0 && node.broken_behind >= 0)
      return ": line " + name_of(nodes, node.broken_before) + " -> " + name_of(nodes, node.broken_behind) + " broken";
  return "";
}

/// Of two breaks each part is a ring of its own.
std::string fold(const Nodes& nodes, std::size_t working) {
  std::size_t part = nodes.size();
  for (const NodeStatus& node : nodes)
    if (node.state == "folded" && node.ring_size != 0) part = std::min<std::size_t>(part, node.ring_size);
  return part < working ? ", folded back in parts" : ", folded back around a break";
}

}  // namespace

void tell_ring(const RingStatus& ring, diagnostic_updater::DiagnosticStatusWrapper& out) {
  const Nodes& nodes = ring.nodes;
  const std::size_t up = in_state(nodes, "up"), open = in_state(nodes, "open_chain"),
                    folded = in_state(nodes, "folded");
  const std::size_t working = up + open + folded;
  const std::string counted = std::to_string(working) + " of " + std::to_string(nodes.size()) + " nodes ";
  if (!ring.connected)
    out.summary(Level::ERROR, ring.message);
  else if (open != 0)
    out.summary(Level::WARN, counted + "work, open chain" + broken_line(nodes));
  else if (folded != 0)
    out.summary(Level::WARN, counted + "up" + fold(nodes, working));
  else
    out.summary(up == nodes.size() ? Level::OK : Level::WARN, counted + "up");
  const auto stopped = std::count_if(nodes.begin(), nodes.end(), [](const NodeStatus& node) { return node.stopped; });
  if (stopped > 0) out.mergeSummary(Level::WARN, std::to_string(stopped) + " stopped until `resume`");
}

}  // namespace limb_ring::bridge
