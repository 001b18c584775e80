#include "ros_bridge/command_in.h"

#include <stdexcept>

#include "ask/arrived.h"
#include "ask/resume_cpu.h"
#include "limb_ring/payload/packet_type.h"
#include "ros_bridge/outcome_word.h"

namespace limb_ring::bridge {
namespace {

constexpr unsigned kUnderWay = 2;
constexpr std::size_t kWarnedLimit = 1000;  // names; a broken sender must not fill the memory
constexpr std::uint8_t kCommandPriority = 0;

}  // namespace

CommandIn::CommandIn(ros::NodeHandle& nodes, const config::RingConfig& ring, RingPort& port, Speaks speaks,
                     Counters& counters)
    : joints_(ring),
      valid_for_us_(static_cast<std::uint32_t>(std::chrono::microseconds(ring.timeouts.command).count())),
      port_(port),
      speaks_(std::move(speaks)),
      counters_(counters) {
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
    const bool posted = port_.post([this, parts = std::move(split.parts), came = RingPort::Clock::now(),
                                    heard = Heard{topic, event.getPublisherName(), message->header.stamp}]() mutable {
      heard_(heard);
      for (auto& part : parts) {
        stamp(part.command, came);
        offer(part);
      }
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
    ROS_WARN("%s: no node of the ring owns joint '%s'; there are: %s", topic.c_str(), name.c_str(),
             joints_.names().c_str());
  }
}

void CommandIn::offer(const CommandSplit::Part& part) {
  NodeCommands& commands = by_node_[part.node];
  if (!port_.connected()) return counters_.lose("commands_dropped_disconnected");
  if (!speaks_(part.node)) return counters_.lose("commands_withheld_silent");
  auto done = [this, node = part.node](const Result& result) { on_result(node, result); };
  if (commands.under_way < kUnderWay) return send(part.node, part.command, done);
  if (const unsigned replaced = commands.waiting.put(part.command)) counters_.add("commands_superseded", replaced);
}

void CommandIn::send(std::uint8_t node, payload::JointCommand command, RingPort::OnResult done) {
  NodeCommands& commands = by_node_[node];
  command.sequence = commands.sequence++;
  const auto bytes = payload::encode(command);
  if (!bytes) {
    // Only a configuration with more joints per node than a packet holds gets here.
    ROS_ERROR_ONCE("command to node %u cannot be written: %s", node, payload::to_string(bytes.error()).c_str());
    return counters_.lose("commands_refused");
  }
  ++commands.under_way;
  port_.send({node, kCommandPriority, payload::kJointChannel, *bytes}, std::move(done));
}

void CommandIn::on_result(std::uint8_t node, const Result& result) {
  const std::string ended = "commands_" + outcome_word(result.outcome);
  if (ask::may_have_arrived(result))
    counters_.add(ended);
  else
    counters_.lose(ended);
  NodeCommands& commands = by_node_[node];
  --commands.under_way;
  if (commands.waiting.size() == 0) return;
  if (!port_.connected()) {
    counters_.lose("commands_dropped_disconnected", commands.waiting.size());
    return commands.waiting.clear();
  }
  send(node, *commands.waiting.take(), [this, node](const Result& r) { on_result(node, r); });
}

bool CommandIn::resume(std::uint8_t node, RingPort::OnResult done) {
  return port_.post([this, node, done = std::move(done), came = RingPort::Clock::now()] {
    send(node, ask::resume_command(port_.stamp_of(came)), [this, node, done](const Result& result) {
      on_result(node, result);
      done(result);
    });
  });
}

}  // namespace limb_ring::bridge
