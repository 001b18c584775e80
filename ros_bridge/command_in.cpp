#include "ros_bridge/command_in.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>

#include "limb_ring/payload/packet_type.h"
#include "ring/known_stops.h"
#include "ring/reset_node.h"
#include "ros_bridge/conversions.h"

namespace limb_ring::bridge {
namespace {

constexpr unsigned kUnderWay = 2;
constexpr std::chrono::milliseconds kPatience{50};  // of a set, for commands to nodes alone
constexpr std::uint8_t kCommandPriority = 0;
/// Of what a set's refusal leads to: one to a node whose CPU has just crashed is tried again for a second, and holds
/// its priority back. The next sets pass it.
constexpr std::uint8_t kAfterRefusal = 1;

payload::CommandSet set_of(const std::vector<CommandSplit::Part>& parts) {
  payload::CommandSet set;
  set.stamp_ns = parts.front().command.stamp_ns;
  set.valid_for_us = parts.front().command.valid_for_us;
  for (const auto& part : parts) set.parts.push_back({part.node, part.command.joints});
  return set;
}

}  // namespace

CommandSender::CommandSender(bool broadcast, RingPort& port, Speaks speaks, Counters& counters)
    : broadcast_(broadcast), port_(port), speaks_(std::move(speaks)), counters_(counters) {}

void CommandSender::offer(const std::vector<Part>& parts) {
  if (!port_.connected()) return counters_.lose("commands_dropped_disconnected", parts.size());
  for (const Part& part : parts) {
    if (broadcast_)
      put_in_wait(part);
    else if (!is_silent(part.node))
      by_node_[part.node].under_way < kUnderWay ? send_alone(part.node, part.command, kCommandPriority)
                                                : put_in_wait(part);
  }
  if (broadcast_) send_set();
}

bool CommandSender::is_silent(std::uint8_t node) {
  if (speaks_(node)) return false;
  counters_.lose("commands_withheld_silent");
  return true;
}

void CommandSender::put_in_wait(const Part& part) {
  if (const unsigned replaced = by_node_[part.node].waiting.put(part.command))
    counters_.add("commands_superseded", replaced);
}

// ---- to one node ----------------------------------------------------------------------------

void CommandSender::send(std::uint8_t node, payload::JointCommand command, RingPort::OnResult done) {
  send_alone(node, std::move(command), kCommandPriority, std::move(done));
}

void CommandSender::send_alone(std::uint8_t node, payload::JointCommand command, std::uint8_t priority,
                               RingPort::OnResult done) {
  NodeCommands& commands = by_node_[node];
  command.sequence = broadcast_ ? sequence_++ : commands.sequence++;
  const auto bytes = payload::encode(command);
  if (!bytes) {
    // Only a configuration with more joints per node than a packet holds gets here.
    ROS_ERROR_ONCE("command to node %u cannot be written: %s", node, payload::to_string(bytes.error()).c_str());
    return counters_.lose("commands_refused");
  }
  ++commands.under_way;
  ++alone_under_way_;
  alone_sent_ = port_.now();
  port_.send({node, priority, payload::kJointChannel, *bytes}, [this, node, done](const Result& result) {
    on_result(node, result);
    done(result);
  });
}

void CommandSender::send_each(const std::vector<Part>& parts, std::uint8_t priority) {
  for (const Part& part : parts)
    if (!is_silent(part.node)) send_alone(part.node, part.command, priority);
}

void CommandSender::on_result(std::uint8_t node, const Result& result) {
  count(result, 1);
  NodeCommands& commands = by_node_[node];
  --commands.under_way;
  --alone_under_way_;
  if (!port_.connected()) return drop_waiting();
  if (broadcast_) return send_set();
  if (commands.waiting.size() != 0) send_alone(node, *commands.waiting.take(), kCommandPriority);
}

bool CommandSender::waits_for_those_alone() const {
  return alone_under_way_ != 0 && port_.now() < alone_sent_ + kPatience;
}

// ---- to several -----------------------------------------------------------------------------

// What is for one node alone is sent to it, and again where that refuses it.
void CommandSender::send_set() {
  while (!set_under_way_ && !waits_for_those_alone()) {
    const std::vector<Part> parts = take_oldest();
    if (parts.empty()) return;
    parts.size() > 1 ? broadcast(parts) : send_each(parts, kCommandPriority);
  }
}

/// Those that were given at the oldest instant, as many as fit into one packet.
std::vector<CommandSplit::Part> CommandSender::take_oldest() {
  const payload::JointCommand* oldest = nullptr;
  for (const auto& [node, commands] : by_node_) {
    const payload::JointCommand* next = commands.waiting.oldest();
    if (next != nullptr && (oldest == nullptr || next->stamp_ns < oldest->stamp_ns)) oldest = next;
  }
  std::vector<Part> parts;
  if (oldest == nullptr) return parts;
  const std::int64_t stamp = oldest->stamp_ns;
  std::size_t bytes = payload::kCommandSetHeader;
  for (auto& [node, commands] : by_node_) {
    const payload::JointCommand* next = commands.waiting.oldest();
    if (next == nullptr || next->stamp_ns != stamp) continue;
    bytes += payload::encoded_size({node, next->joints});
    if (bytes > payload::kMaxPacket && !parts.empty()) break;
    parts.push_back({node, *commands.waiting.take()});
  }
  return parts;
}

void CommandSender::broadcast(const std::vector<Part>& parts) {
  payload::CommandSet set = set_of(parts);
  set.sequence = sequence_++;
  const auto bytes = payload::encode(set);
  if (!bytes) {
    ROS_ERROR_ONCE("commands cannot be written: %s", payload::to_string(bytes.error()).c_str());
    return counters_.lose("commands_refused", parts.size());
  }
  set_under_way_ = true;
  port_.send({kBroadcast, kCommandPriority, payload::kJointChannel, *bytes},
             [this, parts](const Result& result) { on_set_result(parts, result); });
}

void CommandSender::on_set_result(const std::vector<Part>& parts, const Result& result) {
  set_under_way_ = false;
  if (!port_.connected()) drop_waiting();
  if (result.outcome == Outcome::refused && alone_under_way_ == 0)
    send_each(parts, kAfterRefusal);
  else
    count(result, parts.size());
  send_set();
}

// ---- counters -------------------------------------------------------------------------------

void CommandSender::count(const Result& result, std::uint64_t commands) {
  const std::string ended = "commands_" + outcome_word(result.outcome);
  if (ask::may_have_arrived(result))
    counters_.add(ended, commands);
  else
    counters_.lose(ended, commands);
}

void CommandSender::drop_waiting() {
  for (auto& [node, commands] : by_node_) {
    if (commands.waiting.size() == 0) continue;
    counters_.lose("commands_dropped_disconnected", commands.waiting.size());
    commands.waiting.clear();
  }
}

namespace {

constexpr std::size_t kWarnedLimit = 1000;  // names; a broken sender must not fill the memory

}  // namespace

CommandIn::CommandIn(ros::NodeHandle& nodes, const config::RingConfig& ring, RingPort& port,
                     CommandSender::Speaks speaks, Counters& counters)
    : joints_(ring),
      valid_for_us_(static_cast<std::uint32_t>(std::chrono::microseconds(ring.timeouts.command).count())),
      port_(port),
      counters_(counters),
      sender_(ring.bridge.broadcast_commands, port, std::move(speaks), counters) {
  subscribe(nodes, "joint_commands");
  for (const std::string& topic : ring.bridge.lockstep) subscribe(nodes, topic);
}

void CommandIn::subscribe(ros::NodeHandle& nodes, const std::string& topic) {
  if (subscribers_.count(topic) != 0) return;
  const boost::function<void(const Event&)> call = [this, topic](const Event& event) { on_command(topic, event); };
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const Event&>(topic, 1, call);
  options.callback_queue = &at_once_;
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  subscribers_[topic] = nodes.subscribe(options);
}

void CommandIn::on_command(const std::string& topic, const Event& event) {
  const sensor_msgs::JointState::ConstPtr& message = event.getMessage();
  counters_.add("commands_in");
  try {
    auto split = split_command(*message, joints_);
    if (!split.unknown.empty()) warn_unknown(topic, split.unknown);
    if (!split.not_given.empty()) warn_not_given(topic, split.not_given);
    const bool posted = port_.post([this, parts = std::move(split.parts), came = RingPort::Clock::now(),
                                    heard = Heard{topic, event.getPublisherName(), message->header.stamp}]() mutable {
      heard_(heard);
      for (auto& part : parts) stamp(part.command, came);
      sender_.offer(parts);
    });
    if (!posted) counters_.lose("commands_dropped_busy");
  } catch (const std::invalid_argument& error) {
    counters_.lose("commands_refused");
    if (refusal_.allow()) ROS_WARN("%s: command refused: %s", topic.c_str(), error.what());
  }
}

void CommandIn::stamp(payload::JointCommand& command, RingPort::Clock::time_point came) {
  command.stamp_ns = port_.stamp_of(came);
  command.valid_for_us = valid_for_us_;
}

void CommandIn::warn_unknown(const std::string& topic, const std::vector<std::string>& names) {
  counters_.add("commands_unknown_joint", names.size());
  for (const auto& name : names) {
    if (warned_.size() >= kWarnedLimit || !warned_.insert(name).second) continue;
    const std::string leader = joints_.leader_of(name);
    if (leader.empty())
      ROS_WARN("%s: no node of the ring owns joint '%s'; there are: %s", topic.c_str(), name.c_str(),
               joints_.names().c_str());
    else
      ROS_WARN("%s: joint '%s' is refused: it has no motor, and follows '%s'; command that one", topic.c_str(),
               name.c_str(), leader.c_str());
  }
}

void CommandIn::warn_not_given(const std::string& topic, const std::vector<std::string>& names) {
  counters_.lose("commands_not_given", names.size());
  if (const auto held_back = not_given_.allow())
    ROS_WARN("%s: joint '%s' is named but not commanded: all its values are NaN%s", topic.c_str(),
             names.front().c_str(), process::and_more(*held_back).c_str());
}

bool CommandIn::resume(std::uint8_t node, RingPort::OnResult done) {
  return port_.post([this, node, done = std::move(done), came = RingPort::Clock::now()] {
    sender_.send(node, ask::resume_command(port_.stamp_of(came)), done);
  });
}

namespace {

constexpr const char* kValuesLeftOut = "sensor_values_left_out";

std::array<double, 3> axes(const geometry_msgs::Vector3& vector) { return {vector.x, vector.y, vector.z}; }
std::array<double, 3> linear_of(const sensor_msgs::Imu& imu) { return axes(imu.linear_acceleration); }
std::array<double, 3> angular_of(const sensor_msgs::Imu& imu) { return axes(imu.angular_velocity); }
std::array<double, 3> linear_of(const geometry_msgs::WrenchStamped& wrench) { return axes(wrench.wrench.force); }
std::array<double, 3> angular_of(const geometry_msgs::WrenchStamped& wrench) { return axes(wrench.wrench.torque); }

}  // namespace

SensorIn::SensorIn(ros::NodeHandle& nodes, const config::RingConfig& ring, RingPort& port, Counters& counters)
    : port_(port), counters_(counters) {
  for (const config::NodeConfig& node : ring.nodes)
    for (std::size_t i = 0; i < node.sensors.size(); ++i) {
      const config::SensorConfig& sensor = node.sensors[i];
      if (sensor.topic.empty()) continue;
      const bool imu = sensor.kind == config::SensorConfig::Kind::imu;
      const auto period =
          std::chrono::duration_cast<RingPort::Clock::duration>(std::chrono::duration<double>(1 / sensor.rate));
      payload::SensorReading next;
      next.kind = imu ? payload::SensorReading::Kind::imu : payload::SensorReading::Kind::force;
      next.sensor = static_cast<std::uint8_t>(i);
      Source& source = sources_.emplace_back(Source{node.id, sensor.priority, period, next});
      subscribers_.push_back(imu ? subscribe<sensor_msgs::Imu>(nodes, sensor.topic, source)
                                 : subscribe<geometry_msgs::WrenchStamped>(nodes, sensor.topic, source));
    }
}

template <typename Message>
ros::Subscriber SensorIn::subscribe(ros::NodeHandle& nodes, const std::string& topic, Source& source) {
  const boost::function<void(const Message&)> call = [this, &source](const Message& message) {
    take(source, linear_of(message), angular_of(message));
  };
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const Message&>(topic, 1, call);
  options.callback_queue = &at_once_;
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  return nodes.subscribe(options);
}

void SensorIn::take(Source& source, const std::array<double, 3>& linear, const std::array<double, 3>& angular) {
  counters_.add("sensor_values_in");
  const bool posted = port_.post([this, &source, linear, angular] {
    source.next.linear = linear;
    source.next.angular = angular;
    send(source);
  });
  if (!posted) counters_.lose(kValuesLeftOut);
}

// What comes a little early, as from a publisher of that very rate, is in time; what comes on is not faster for it.
void SensorIn::send(Source& source) {
  const auto now = port_.now();
  if (source.under_way || now + source.period / 2 < source.not_before) return counters_.add(kValuesLeftOut);
  if (!port_.connected()) return counters_.lose("sensor_values_dropped_disconnected");
  source.next.stamp_ns = port_.stamp_of(RingPort::Clock::now());
  const auto bytes = payload::encode(source.next);
  if (!bytes) return counters_.lose("sensor_values_refused");  // NaN
  source.not_before = std::max(source.not_before, now) + source.period;
  ++source.next.sequence;
  source.under_way = true;
  port_.send({source.node, source.priority, payload::kJointChannel, *bytes}, [this, &source](const Result& result) {
    source.under_way = false;
    const std::string ended = "sensor_values_" + outcome_word(result.outcome);
    if (ask::may_have_arrived(result))
      counters_.add(ended);
    else
      counters_.lose(ended);
  });
}

}  // namespace limb_ring::bridge
