#include "ros_bridge/node_health.h"

#include <algorithm>
#include <string>

#include "config/ring_config.h"
#include "ring/status_rows.h"
#include "wire/control_message.h"

namespace limb_ring::bridge {
namespace {

using diagnostic_updater::DiagnosticStatusWrapper;
using Level = diagnostic_msgs::DiagnosticStatus;

bool is_well(const std::string& state) { return state == "up"; }

std::string seconds_ago(std::chrono::steady_clock::duration time) {
  return std::to_string(std::chrono::duration_cast<std::chrono::seconds>(time).count()) + " s";
}

int level_of(const std::string& state) {
  if (state == "up") return Level::OK;
  return state == "alone" || state == "duplicate_id" ? Level::ERROR : Level::WARN;
}

}  // namespace

NodeHealth::NodeHealth(const config::NodeConfig& node, std::chrono::milliseconds beacon)
    : config_(node),
      longest_silence_(wire::kMissedBeacons * std::chrono::duration<double>(beacon).count()),
      errors_(ask::ErrorCounter::Of::node) {}

void NodeHealth::take(const RingStatus& ring, Clock::time_point now) {
  const auto found = std::find_if(ring.nodes.begin(), ring.nodes.end(),
                                  [this](const NodeStatus& node) { return node.id == config_.id; });
  if (found == ring.nodes.end()) return;
  note_changes(*found, now);
  status_ = *found;
  bridge_connected_ = ring.connected;
  silent_sensors_.clear();
  for (const auto& sensor : config_.sensors)
    if (std::count(ring.silent_sensors.begin(), ring.silent_sensors.end(), sensor.name) != 0)
      silent_sensors_.push_back(sensor.name);
  has_silent_joints_ = std::any_of(config_.joints.begin(), config_.joints.end(), [&](const auto& joint) {
    return std::count(ring.silent_joints.begin(), ring.silent_joints.end(), joint.name) != 0;
  });
  if (!is_heard()) return;
  was_heard_ = true;
  heard_at_ = now;
}

// A daemon on this host answers itself. A node on another host is known only by its beacons, which may be old.
bool NodeHealth::is_heard() const {
  if (status_.state.empty() || status_.state == "down") return false;
  return status_.pid != 0 || status_.beacon_age <= longest_silence_;
}

void NodeHealth::note_changes(const NodeStatus& now, Clock::time_point at) {
  for (const auto& step : errors_.take(now)) recent_.note(step.name, step.name + " +" + std::to_string(step.by), at);
  if (now.states_missing > status_.states_missing)
    recent_.note("states", "joint states missing +" + std::to_string(now.states_missing - status_.states_missing), at);
  if (now.commands_not_obeyed > status_.commands_not_obeyed)
    recent_.note("commands",
                 "commands not obeyed +" + std::to_string(now.commands_not_obeyed - status_.commands_not_obeyed), at);
  if (was_heard_ && is_well(now.state) && !is_well(status_.state)) recent_.note("state", "was " + status_.state, at);
  if (now.cpu_boots > status_.cpu_boots && status_.cpu_boots != 0)
    recent_.note("boots", "its CPU was restarted (boot " + std::to_string(now.cpu_boots) + ")", at);
  if (now.pid == 0) return;
  if (last_pid_ != 0 && now.pid != last_pid_) recent_.note("pid", "its daemon was restarted", at);
  last_pid_ = now.pid;
}

void NodeHealth::tell(DiagnosticStatusWrapper& out, Clock::time_point now) {
  out.summary(Level::OK, "");
  tell_node(out, now);
  if (is_heard()) {
    tell_cpu(out);
    if (status_.second_input_state == "down")
      out.mergeSummary(Level::WARN,
                       "broken second line into it: the ring can fold back only around the line out of it");
    for (const std::string& refusal : status_.refusals) out.mergeSummary(Level::ERROR, refusal);
    recent_.each(now, [&](const std::string& text) { out.mergeSummary(Level::WARN, text); });
  }
  if (out.level == Level::OK) out.summary(Level::OK, "up");
  tell_values(out);
}

void NodeHealth::tell_node(DiagnosticStatusWrapper& out, Clock::time_point now) const {
  if (is_heard()) {
    if (!is_well(status_.state)) out.mergeSummary(static_cast<unsigned char>(level_of(status_.state)), status_.state);
  } else if (!bridge_connected_) {
    // Not Level::ERROR: nothing is known of this node. The problem is reported at the bridge's own node.
    out.summary(Level::STALE, "nobody to ask: the bridge has no connection to its daemon");
  } else if (was_heard_) {
    out.summary(Level::ERROR, "down: not heard for " + seconds_ago(now - heard_at_));
  } else {
    out.summary(Level::STALE, "nobody has heard of it");
  }
}

void NodeHealth::tell_cpu(DiagnosticStatusWrapper& out) const {
  const std::string& cpu = status_.cpu_state;
  if (cpu == "silent" || cpu == "hung" || cpu == "failed")
    out.mergeSummary(Level::ERROR, cpu == "failed" ? "its CPU has failed" : "its CPU hangs");
  else if (cpu == "absent" || cpu == "booting")
    out.mergeSummary(Level::WARN, "its CPU is " + cpu);
  if (has_silent_joints_) out.mergeSummary(Level::WARN, "no joint states of it");
  for (const std::string& sensor : silent_sensors_) out.mergeSummary(Level::WARN, "no readings of " + sensor);
  if (!status_.problem.empty()) out.mergeSummary(Level::WARN, status_.problem);
  if (status_.stopped) out.mergeSummary(Level::WARN, "stopped until `resume`");
}

void NodeHealth::tell_values(DiagnosticStatusWrapper& out) const {
  out.add("state", status_.state);
  out.add("CPU state", status_.cpu_state);
  out.add("CPU boots", status_.cpu_boots);
  if (status_.pid == 0) return;  // known by its beacons alone: a foreign node, or one of another host
  out.add("pid", status_.pid);
  out.add("ring size", status_.ring_size);
  out.add("round trip p50 (us)", status_.round_trip_p50 * 1e6);
  out.add("round trip p99 (us)", status_.round_trip_p99 * 1e6);
  out.add("round trip max (us)", status_.round_trip_max * 1e6);
  out.add("joint states missing", status_.states_missing);
  out.add("commands not obeyed", status_.commands_not_obeyed);
  for (const std::string& name : errors_.names()) out.add(name, counter_of(status_, name));
}

namespace {

using Nodes = std::vector<NodeStatus>;

std::string name_of(const Nodes& nodes, int id) {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [id](const NodeStatus& node) { return node.id == id; });
  return found != nodes.end() ? found->name : std::to_string(id);
}

/// "A -> B"; empty if nobody knows of one.
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

/// Empty if none is stopped.
std::string stopped_in_words(const Nodes& nodes) {
  const auto stopped = std::count_if(nodes.begin(), nodes.end(), [](const NodeStatus& node) { return node.stopped; });
  return stopped == 0 ? "" : std::to_string(stopped) + " stopped until `resume`";
}

/// "CPU of left_knee silent"; empty if none has failed.
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
