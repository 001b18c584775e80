#include "ros_bridge/command_in.h"

#include <stdexcept>

#include "ring/known_stops.h"

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
      ROS_WARN("%s: joint '%s' is refused: it has no motor and follows '%s', which can be commanded", topic.c_str(),
               name.c_str(), leader.c_str());
  }
}

void CommandIn::warn_not_given(const std::string& topic, const std::vector<std::string>& names) {
  counters_.lose("commands_not_given", names.size());
  if (const auto held_back = not_given_.allow())
    ROS_WARN("%s: joint '%s' is named and not commanded: all that is said of it is NaN%s", topic.c_str(),
             names.front().c_str(), and_more(*held_back).c_str());
}

bool CommandIn::resume(std::uint8_t node, RingPort::OnResult done) {
  return port_.post([this, node, done = std::move(done), came = RingPort::Clock::now()] {
    sender_.send(node, ask::resume_command(port_.stamp_of(came)), done);
  });
}

}  // namespace limb_ring::bridge
