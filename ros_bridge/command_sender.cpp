#include "ros_bridge/command_sender.h"

#include <chrono>
#include <string>
#include <utility>

#include "limb_ring/payload/packet_type.h"
#include "ring/reset_node.h"
#include "ros_bridge/status_conversion.h"

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

}  // namespace limb_ring::bridge
