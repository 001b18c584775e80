#include "ros_bridge/ring_health.h"

#include <algorithm>
#include <string>

#include "config/names.h"
#include "ring/ring_words.h"

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

bool all_up(const Nodes& nodes) {
  return std::all_of(nodes.begin(), nodes.end(), [](const NodeStatus& node) { return node.state == "up"; });
}

/// Empty where none is stopped.
std::string stopped_in_words(const Nodes& nodes) {
  const auto stopped = std::count_if(nodes.begin(), nodes.end(), [](const NodeStatus& node) { return node.stopped; });
  return stopped == 0 ? "" : std::to_string(stopped) + " stopped until `resume`";
}

/// "CPU of left_knee silent"; empty where none has failed.
std::string failed_cpus(const Nodes& nodes) {
  std::string text;
  for (const NodeStatus& node : nodes)
    if (node.state != "down" && (node.cpu_state == "silent" || node.cpu_state == "hung" || node.cpu_state == "failed"))
      text += (text.empty() ? "CPU of " : ", CPU of ") + node.name + ' ' + node.cpu_state;
  return text;
}

}  // namespace

void tell_ring(const RingStatus& ring, diagnostic_updater::DiagnosticStatusWrapper& out) {
  if (ring.connected)
    out.summary(all_up(ring.nodes) ? Level::OK : Level::WARN, in_words(ring.nodes));
  else
    out.summary(Level::ERROR, ring.message);
  if (const std::string stopped = stopped_in_words(ring.nodes); !stopped.empty())
    out.mergeSummary(Level::WARN, stopped);
}

std::string what_is_wrong(const std::vector<NodeStatus>& nodes) {
  std::vector<std::string> parts{all_up(nodes) ? "" : in_words(nodes), failed_cpus(nodes), stopped_in_words(nodes)};
  parts.erase(std::remove(parts.begin(), parts.end(), ""), parts.end());
  return config::join(parts, "; ");
}

}  // namespace limb_ring::bridge
