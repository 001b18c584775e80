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
/// A newer one takes the place of what older ones say of the same joints, since an old command is worth nothing; what
/// they say of other joints still counts, each with the stamp of its own. So no more wait than the node has joints.
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
  /// The oldest one; null where none waits.
  const payload::JointCommand* oldest() const { return commands_.empty() ? nullptr : &commands_.front(); }
  /// The same, which waits no more.
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
/// One packet per node: at most two commands to a node are under way. A newer one replaces, joint by joint, what waits:
/// the counter commands_superseded is of joints. A node whose joints are silent gets none: its controller would refuse
/// each, and while that is tried again, for a second, it would hold up the commands to all others.
///
/// With `bridge: {broadcast_commands: true}` what is for several nodes goes as one broadcast, a command set, of which
/// one is under way at a time. It is for silent nodes as well: there they hold up nothing. A broadcast is not sent
/// again for a refusal; so where a node has refused it, the commands go to each of its nodes alone. The next set waits
/// for those, but for 50 ms at most; if it is refused while some of them are still under way, that is its end. (ours)
class CommandSender {
 public:
  /// Whether a node (by id) sends states of its joints.
  using Speaks = std::function<bool(std::uint8_t node)>;

  CommandSender(bool broadcast, RingPort& port, Speaks speaks, Counters& counters);

  /// All that one message says, with their stamps.
  void offer(const std::vector<CommandSplit::Part>& parts);
  /// At once, to that node alone; its sequence number is set here. `done` is called once.
  void send(std::uint8_t node, payload::JointCommand command, RingPort::OnResult done);

 private:
  using Part = CommandSplit::Part;
  /// What has been sent to one node and not yet come back, and what waits for that.
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
  std::uint16_t sequence_ = 0;  ///< where sets are sent, for all nodes
};

}  // namespace limb_ring::bridge
