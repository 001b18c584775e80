#include "ros_bridge/command_in.h"

#include <algorithm>
#include <stdexcept>

#include "limb_ring/payload/packet_type.h"
#include "ring/known_stops.h"
#include "ring/reset_node.h"
#include "ros_bridge/status_conversion.h"

namespace limb_ring::bridge {
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
