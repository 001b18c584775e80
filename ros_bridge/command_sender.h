#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "limb_ring/payload/command_set.h"
#include "ros_bridge/conversions.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/ring_port.h"
#include "ros_bridge/waiting_commands.h"

namespace limb_ring::bridge {

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
