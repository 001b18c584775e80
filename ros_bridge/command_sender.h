#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/joint_command.h"
#include "ros_bridge/conversions.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/ring_port.h"

namespace limb_ring::bridge {

/// Commands to one node that wait until others have returned. (ours)
///
/// A newer command replaces what older ones say about the same joints, since an old command is worth nothing. What the
/// older ones say about other joints still counts, with its own stamp. So at most as many wait as the node has joints.
class WaitingCommands {
 public:
  /// @return joints whose older command was replaced
  unsigned put(payload::JointCommand newer) {
    unsigned replaced = 0;
    for (payload::JointCommand& older : commands_) replaced += take_out(older, newer);
    commands_.erase(std::remove_if(commands_.begin(), commands_.end(), says_nothing), commands_.end());
    commands_.push_back(std::move(newer));
    return replaced;
  }
  /// The oldest one; null if none waits.
  const payload::JointCommand* oldest() const { return commands_.empty() ? nullptr : &commands_.front(); }
  /// Removes and returns the oldest one.
  std::optional<payload::JointCommand> take() {
    if (commands_.empty()) return std::nullopt;
    payload::JointCommand oldest = std::move(commands_.front());
    commands_.pop_front();
    return oldest;
  }
  std::size_t size() const { return commands_.size(); }
  void clear() { commands_.clear(); }

 private:
  using Joint = payload::JointCommand::Joint;
  static bool commands(const Joint& joint) { return joint.position || joint.velocity || joint.effort; }
  static bool says_nothing(const payload::JointCommand& command) {
    return std::none_of(command.joints.begin(), command.joints.end(), commands);
  }
  static unsigned take_out(payload::JointCommand& older, const payload::JointCommand& newer) {
    unsigned replaced = 0;
    for (std::size_t i = 0; i < std::min(older.joints.size(), newer.joints.size()); ++i) {
      if (!commands(older.joints[i]) || !commands(newer.joints[i])) continue;
      older.joints[i] = {};
      ++replaced;
    }
    return replaced;
  }

  std::deque<payload::JointCommand> commands_;  ///< the oldest first
};

/// Sends commands to the nodes; ring thread only.
///
/// One packet per node: at most two commands to a node are under way. A newer one replaces the waiting ones joint by
/// joint: the counter commands_superseded counts joints. A node whose joints are silent gets no command: its controller
/// would refuse each, and the retries, which last a second, would hold up the commands to all other nodes.
///
/// With `bridge: {broadcast_commands: true}` a message for several nodes goes as one broadcast, a command set. One set
/// is under way at a time. It includes silent nodes, which hold up nothing in a broadcast. A broadcast is not sent
/// again after a refusal: if a node refuses it, the commands go to each node of the set separately. The next set waits
/// for these at most 50 ms. If that set is refused while some of them are still under way, it is dropped. (ours)
class CommandSender {
 public:
  /// Whether a node (by id) sends states of its joints.
  using Speaks = std::function<bool(std::uint8_t node)>;

  CommandSender(bool broadcast, RingPort& port, Speaks speaks, Counters& counters);

  /// All that one message says, with their stamps.
  void offer(const std::vector<CommandSplit::Part>& parts);
  /// Sends at once, to that node only, and sets the sequence number. `done` is called once.
  void send(std::uint8_t node, payload::JointCommand command, RingPort::OnResult done);

 private:
  using Part = CommandSplit::Part;
  /// What was sent to one node and has not returned yet, and the commands that wait for it.
  struct NodeCommands {
    unsigned under_way = 0;
    WaitingCommands waiting;
    std::uint16_t sequence = 0;
  };

  bool is_silent(std::uint8_t node);
  void put_in_wait(const Part& part);
  void send_alone(
      std::uint8_t node, payload::JointCommand command, std::uint8_t priority,
      RingPort::OnResult done = [](const Result&) {});
  void send_each(const std::vector<Part>& parts, std::uint8_t priority);
  void on_result(std::uint8_t node, const Result& result);
  bool waits_for_those_alone() const;
  void send_set();
  std::vector<Part> take_oldest();
  void broadcast(const std::vector<Part>& parts);
  void on_set_result(const std::vector<Part>& parts, const Result& result);
  void count(const Result& result, std::uint64_t commands);
  void drop_waiting();

  bool broadcast_;
  RingPort& port_;
  Speaks speaks_;
  Counters& counters_;
  std::map<std::uint8_t, NodeCommands> by_node_;
  unsigned alone_under_way_ = 0;              ///< commands to one node
  RingPort::Clock::time_point alone_sent_{};  ///< the last of those
  bool set_under_way_ = false;
  std::uint16_t sequence_ = 0;  ///< of command sets, one for all nodes
};

}  // namespace limb_ring::bridge
