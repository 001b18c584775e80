#include "ros_bridge/conversions.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>

#include "config/quantity.h"

namespace limb_ring::bridge {
namespace {

using Values = std::vector<double>;

void check_array(const char* name, const Values& values, const std::vector<std::string>& joints) {
  if (!values.empty() && values.size() != joints.size())
    throw std::invalid_argument(std::string("'") + name + "' has " + std::to_string(values.size()) + " entries for " +
                                std::to_string(joints.size()) + " names; it must be empty or have one for each name");
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isinf(values[i]))
      throw std::invalid_argument(std::string("'") + name + "' of joint '" + config::printable(joints[i]) + "' is " +
                                  (values[i] > 0 ? "" : "minus ") +
                                  "infinity; it must be a finite number, or NaN where it is not given");
}

void check(const sensor_msgs::JointState& message) {
  if (message.name.empty()) throw std::invalid_argument("'name' is empty; it must name the joints");
  if (message.position.empty() && message.velocity.empty() && message.effort.empty())
    throw std::invalid_argument(
        "'position', 'velocity' and 'effort' are all empty; one of them must command something");
  check_array("position", message.position, message.name);
  check_array("velocity", message.velocity, message.name);
  check_array("effort", message.effort, message.name);
  std::set<std::string> seen;
  for (const auto& name : message.name)
    if (!seen.insert(name).second)
      throw std::invalid_argument("joint '" + config::printable(name) + "' is named twice");
}

std::optional<double> given(const Values& values, std::size_t i) {
  return values.empty() || std::isnan(values[i]) ? std::nullopt : std::optional(values[i]);
}

payload::JointCommand::Joint joint_at(const sensor_msgs::JointState& message, std::size_t i) {
  return {given(message.position, i), given(message.velocity, i), given(message.effort, i)};
}

geometry_msgs::Vector3 to_vector(const std::array<double, 3>& v) {
  geometry_msgs::Vector3 vector;
  vector.x = v[0];
  vector.y = v[1];
  vector.z = v[2];
  return vector;
}

}  // namespace

CommandSplit split_command(const sensor_msgs::JointState& message, const JointMap& joints) {
  check(message);
  CommandSplit split;
  std::vector<payload::JointCommand> commands(joints.nodes());
  for (std::size_t i = 0; i < message.name.size(); ++i) {
    const auto place = joints.find(message.name[i]);
    if (!place) {
      split.unknown.push_back(config::printable(message.name[i]));
      continue;
    }
    const auto joint = joint_at(message, i);
    if (!joint.position && !joint.velocity && !joint.effort) {
      split.not_given.push_back(message.name[i]);
      continue;
    }
    auto& list = commands[place->node].joints;
    list.resize(joints.joints(place->node));
    list[place->joint] = joint;
  }
  for (std::size_t node = 0; node < commands.size(); ++node)
    if (!commands[node].joints.empty()) split.parts.push_back({joints.id(node), std::move(commands[node])});
  return split;
}

sensor_msgs::JointState to_joint_state(const std::vector<JointStore::Joint>& joints, ros::Time stamp) {
  sensor_msgs::JointState message;
  message.header.stamp = stamp;
  for (const auto& joint : joints) {
    message.name.push_back(joint.name);
    message.position.push_back(joint.state.position);
    message.velocity.push_back(joint.state.velocity);
    message.effort.push_back(joint.state.effort);
  }
  return message;
}

sensor_msgs::Imu to_imu(const payload::SensorReading& reading, ros::Time stamp, const std::string& frame) {
  sensor_msgs::Imu message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.orientation_covariance[0] = -1;
  message.linear_acceleration = to_vector(reading.linear);
  message.angular_velocity = to_vector(reading.angular);
  return message;
}

geometry_msgs::WrenchStamped to_wrench(const payload::SensorReading& reading, ros::Time stamp,
                                       const std::string& frame) {
  geometry_msgs::WrenchStamped message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.wrench.force = to_vector(reading.linear);
  message.wrench.torque = to_vector(reading.angular);
  return message;
}

JointMap::JointMap(const config::RingConfig& ring) {
  for (const auto& follower : ring.followers) leaders_[follower.name] = follower.leader;
  for (std::size_t node = 0; node < ring.nodes.size(); ++node) {
    const auto& joints = ring.nodes[node].joints;
    ids_.push_back(ring.nodes[node].id);
    counts_.push_back(joints.size());
    for (std::size_t joint = 0; joint < joints.size(); ++joint) {
      places_[joints[joint].name] = {node, joint};
      names_ += (names_.empty() ? "" : ", ") + joints[joint].name;
    }
  }
}

std::string JointMap::leader_of(const std::string& joint) const {
  const auto found = leaders_.find(joint);
  return found == leaders_.end() ? std::string() : found->second;
}

std::optional<JointMap::Place> JointMap::find(const std::string& joint) const {
  const auto found = places_.find(joint);
  if (found == places_.end()) return std::nullopt;
  return found->second;
}

namespace {

// A state that comes so many numbers later is from a CPU that has restarted: at 100 Hz this
// is ten seconds, long after the node was called silent.
constexpr std::uint16_t kRestart = 1000;

std::uint16_t skipped_between(std::uint16_t last, std::uint16_t now) {
  return static_cast<std::uint16_t>(now - last - 1);
}

std::uint64_t missing_between(std::uint16_t last, std::uint16_t now) {
  const std::uint16_t skipped = skipped_between(last, now);
  return skipped < kRestart ? skipped : 0;
}

/// The count wraps, and a CPU that has restarted counts from 0.
std::uint64_t refused_between(const payload::JointState& last, const payload::JointState& now) {
  if (skipped_between(last.sequence, now.sequence) >= kRestart && now.refused < last.refused) return now.refused;
  return static_cast<std::uint16_t>(now.refused - last.refused);
}

JointStore::Clock::duration three_periods(double rate) {
  return std::chrono::duration_cast<JointStore::Clock::duration>(std::chrono::duration<double>(3 / rate));
}

}  // namespace

JointStore::JointStore(const config::RingConfig& ring)
    : silence_(three_periods(ring.firmware.state_rate)), followers_(ring.followers) {
  for (const auto& config : ring.nodes) {
    if (config.joints.empty()) continue;
    order_.push_back(config.id);
    auto& names = nodes_[config.id].joints;
    for (const auto& joint : config.joints) names.push_back(joint.name);
  }
}

bool JointStore::take(std::uint8_t id, const payload::JointState& state, Clock::time_point now) {
  const auto found = nodes_.find(id);
  if (found == nodes_.end() || found->second.joints.size() != state.joints.size()) return false;
  Node& node = found->second;
  if (node.heard) {
    node.received.missing += missing_between(node.state.sequence, state.sequence);
    node.received.refused += refused_between(node.state, state);
  }
  node.heard = true;
  node.arrived = now;
  node.state = state;
  ++node.received.states;
  node.received.stopped = state.mode.stopped;
  return true;
}

void JointStore::forget() {
  for (auto& [id, node] : nodes_) node.heard = false;
}

bool JointStore::is_fresh(const Node& node, Clock::time_point now, Clock::duration pause) const {
  return node.heard && now - node.arrived <= std::max(silence_, pause);
}

JointStore::Snapshot JointStore::snapshot(Clock::time_point now, Clock::duration pause) const {
  Snapshot snapshot;
  for (const auto id : order_) {
    const Node& node = nodes_.at(id);
    if (!is_fresh(node, now, pause)) {
      snapshot.silent.insert(snapshot.silent.end(), node.joints.begin(), node.joints.end());
      continue;
    }
    const bool first = snapshot.fresh.empty();
    snapshot.oldest_stamp_ns = first ? node.state.stamp_ns : std::min(snapshot.oldest_stamp_ns, node.state.stamp_ns);
    snapshot.samples.push_back({id, node.state.stamp_ns});
    for (std::size_t i = 0; i < node.joints.size(); ++i)
      snapshot.fresh.push_back({node.joints[i], node.state.joints[i]});
  }
  add_followers(snapshot);
  return snapshot;
}

/// They have no motor, so no effort. One whose leader is silent is silent with it.
void JointStore::add_followers(Snapshot& snapshot) const {
  if (followers_.empty()) return;
  std::map<std::string, payload::JointState::Joint> leaders;
  for (const Joint& joint : snapshot.fresh) leaders[joint.name] = joint.state;
  for (const auto& follower : followers_) {
    const auto leader = leaders.find(follower.leader);
    if (leader == leaders.end())
      snapshot.silent.push_back(follower.name);
    else
      snapshot.fresh.push_back({follower.name,
                                {follower.multiplier * leader->second.position + follower.offset,
                                 follower.multiplier * leader->second.velocity, 0}});
  }
}

bool JointStore::speaks(std::uint8_t id, Clock::time_point now, Clock::duration pause) const {
  const auto found = nodes_.find(id);
  return found != nodes_.end() && is_fresh(found->second, now, pause);
}

JointStore::Received JointStore::received(std::uint8_t id) const {
  const auto found = nodes_.find(id);
  return found == nodes_.end() ? Received{} : found->second.received;
}

namespace {

constexpr double kMicroseconds = 1e-6;

/// What its daemon has found to be wrong with its CPU's firmware.
std::string problem_in(const std::vector<status::Warning>& warnings) {
  std::string problem;
  for (const status::Warning& warning : warnings)
    if (warning.rule.rfind("cpu_", 0) == 0) problem += (problem.empty() ? "" : "; ") + warning.text;
  return problem;
}

void take_lines(const status::NodeRow& row, NodeStatus& status) {
  if (row.input) {
    status.input_state = row.input->state;
    if (row.input->from) status.input_from = *row.input->from;
  }
  if (row.output) {
    status.output_state = row.output->state;
    if (row.output->to) status.output_to = *row.output->to;
    status.output_rate = static_cast<double>(row.output->rate_bit_s.value_or(0));
  }
  if (row.fold) status.second_input_state = row.fold->second_input;
  if (!row.broken_line) return;
  status.broken_before = row.broken_line->before;
  status.broken_behind = row.broken_line->behind;
}

}  // namespace

NodeStatus unheard_node(const config::NodeConfig& node) {
  NodeStatus status;
  status.id = node.id;
  status.name = node.name;
  status.state = "down";
  status.cpu_state = "unknown";
  status.beacon_age = -1;
  status.input_state = status.output_state = "unknown";
  status.input_from = status.output_to = status.broken_before = status.broken_behind = -1;
  return status;
}

void merge_status_row(const status::NodeRow& row, NodeStatus& status) {
  status.state = row.state;
  status.pid = row.pid.value_or(0);
  status.ring_size = static_cast<std::uint16_t>(row.ring_size.value_or(0));
  status.cpu_state = row.cpu.hung == true ? "hung" : row.cpu.state;
  status.cpu_pid = row.cpu.pid.value_or(0);
  status.cpu_boots = row.cpu.boots.value_or(0);
  status.stopped = row.cpu.stopped();
  take_lines(row, status);
  status.round_trip_p50 = row.round_trip_us.p50.value_or(0) * kMicroseconds;
  status.round_trip_p99 = row.round_trip_us.p99.value_or(0) * kMicroseconds;
  status.round_trip_max = row.round_trip_us.max.value_or(0) * kMicroseconds;
  for (const status::Refusal& refusal : row.refusals) status.refusals.push_back(refusal.text);
  status.problem = problem_in(row.warnings);
  for (const auto& [name, value] : row.counters) {
    status.counter_names.push_back(name);
    status.counter_values.push_back(value);
  }
}

void merge_beacon(const status::Heard& heard, std::chrono::milliseconds fresh, NodeStatus& status) {
  const bool is_heard = heard.age_ms <= fresh.count();
  if (is_heard && status.state == "down") status.state = "up";
  if (is_heard && status.cpu_state == "unknown") status.cpu_state = heard.cpu_state();
  if (is_heard && status.pid == 0) status.stopped = heard.beacon.stop_latched;
  if (status.cpu_boots == 0) status.cpu_boots = heard.beacon.cpu_boots;
  status.hop = static_cast<std::uint16_t>(heard.hop);
  status.beacon_age = static_cast<double>(heard.age_ms) / 1000;
}

}  // namespace limb_ring::bridge
