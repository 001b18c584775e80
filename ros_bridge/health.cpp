#include "ros_bridge/health.h"

#include <algorithm>
#include <string>

#include "config/ring_config.h"
#include "ring/reset_node.h"
#include "ring/ring_client.h"
#include "wire/control_message.h"

namespace limb_ring::bridge {
namespace {

using diagnostic_updater::DiagnosticStatusWrapper;
using Level = diagnostic_msgs::DiagnosticStatus;

bool is_known(const NodeStatus& node) { return node.input_state == "up" || node.input_state == "down"; }

}  // namespace

LineHealth::LineHealth(const config::NodeConfig& from, const config::NodeConfig& to)
    : from_(from),
      to_(to),
      out_counters_(ask::ErrorCounter::Of::output),
      in_counters_(ask::ErrorCounter::Of::input),
      recent_(kWarnFor) {}

void LineHealth::take(const RingStatus& ring, Clock::time_point now) {
  said_broken_ = false;
  for (const NodeStatus& node : ring.nodes) {
    said_broken_ |= node.broken_before == from_.id && node.broken_behind == to_.id;
    if (node.id == from_.id) note_growth(out_counters_, before_ = node, now);
    if (node.id == to_.id) note_growth(in_counters_, behind_ = node, now);
  }
  const Finding found = finding();
  if (found.level == Level::ERROR) recent_.note("state", "was broken", now);
  if (found.level == Level::WARN) recent_.note("state", "was bypassed", now);
}

void LineHealth::note_growth(CounterGrowth& counters, const NodeStatus& node, Clock::time_point now) {
  for (const auto& step : counters.take(node)) recent_.note(step.name, step.name + " +" + std::to_string(step.by), now);
}

LineHealth::Finding LineHealth::finding() const {
  if (said_broken_) return {Level::ERROR, "broken (or " + from_.name + " does not send)"};
  if (!is_known(before_) && !is_known(behind_)) return {Level::STALE, "neither end is known"};
  // The receiving end knows best. If it is not known (on another host), the sending end tells.
  const bool by_input = is_known(behind_);
  const bool up = by_input ? behind_.input_state == "up" : before_.output_state == "up";
  if (!up) return {Level::ERROR, (by_input ? to_.name + " has no input" : from_.name + " has no output")};
  const int leads = by_input ? behind_.input_from : before_.output_to;
  if (leads == (by_input ? from_.id : to_.id)) return {Level::OK, "up"};
  return {Level::WARN, "bypassed: " + (by_input ? to_.name + " hears node " : from_.name + " sends to node ") +
                           std::to_string(leads)};
}

void LineHealth::tell(DiagnosticStatusWrapper& out, Clock::time_point now) {
  const Finding found = finding();
  out.summary(found.level, found.text);
  if (found.level == Level::OK)
    recent_.each(now, [&](const std::string& text) {
      if (out.level == Level::OK)
        out.summary(Level::WARN, "up; lately: " + text);
      else
        out.mergeSummary(Level::WARN, text);
    });
  out.add("output state", before_.output_state);
  out.add("input state", behind_.input_state);
  out.add("data rate (bit/s)", before_.output_rate);
  for (const std::string& name : out_counters_.names()) out.add(name, counter_of(before_, name));
  for (const std::string& name : in_counters_.names()) out.add(name, counter_of(behind_, name));
}

namespace {

constexpr double kShortest = 0.5;  // s between readings: a status at every change tells no rate

std::uint64_t bytes_in(const NodeStatus& node) {
  return ask::line_bytes_in([&node](const char* name) { return counter_of(node, name); });
}

}  // namespace

void LineLoad::take(const RingStatus& ring) {
  for (const NodeStatus& node : ring.nodes) {
    if (node.output_to >= 0) rates_[static_cast<std::uint8_t>(node.output_to)] = node.output_rate;
    const Count now{bytes_in(node), node.pid, ring.header.stamp};
    Count& before = counts_[node.id];
    const double seconds = (now.at - before.at).toSec();
    const bool goes_on = seconds >= 0 && now.pid == before.pid;  // not where a bag is played once more
    if (goes_on && seconds < kShortest) continue;
    if (goes_on && now.pid != 0 && now.bytes >= before.bytes)
      bytes_per_second_[node.id] = static_cast<double>(now.bytes - before.bytes) / seconds;
    else
      bytes_per_second_.erase(node.id);
    before = now;
  }
  busiest_ = 0;
  for (const auto& [end, bytes] : bytes_per_second_) busiest_ = std::max(busiest_, bytes);
}

std::optional<double> LineLoad::of(std::uint8_t end) const {
  const auto bytes = bytes_per_second_.find(end);
  if (bytes == bytes_per_second_.end()) return std::nullopt;
  const auto rate = rates_.find(end);
  if (rate != rates_.end() && rate->second > 0) return std::min(1.0, 8 * bytes->second / rate->second);
  return busiest_ > 0 ? bytes->second / busiest_ : 0;
}

std::uint64_t counter_of(const NodeStatus& node, const std::string& name) {
  const auto& names = node.counter_names;
  const auto place = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  return place < node.counter_values.size() ? node.counter_values[place] : 0;
}

CounterGrowth::CounterGrowth(ask::ErrorCounter::Of of) {
  for (const ask::ErrorCounter& counter : ask::error_counters())
    if (counter.of == of) names_.push_back(counter.name);
}

std::vector<CounterGrowth::Step> CounterGrowth::take(const NodeStatus& node) {
  std::vector<Step> grown;
  if (node.pid == 0) return grown;  // nobody says
  const bool first = pid_ == 0, restarted = node.pid != pid_;
  pid_ = node.pid;
  for (const std::string& name : names_) {
    const std::uint64_t now = counter_of(node, name);
    const std::uint64_t before = restarted ? 0 : last_[name];
    if (!first && now > before) grown.push_back({name, now - before, now});
    last_[name] = now;
  }
  return grown;
}

namespace {

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
