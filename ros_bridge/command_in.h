#pragma once

#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <chrono>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "ros_bridge/conversions.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/direct_queue.h"
#include "ros_bridge/ring_port.h"
#include "ros_bridge/throttle.h"
#include "ros_bridge/waiting_commands.h"

namespace limb_ring::bridge {

/// `joint_commands` from ROS, and the other topics of `bridge: {lockstep}`, spread over the nodes that own the joints:
/// one packet per node, channel 2, priority 0, stamped with the wall clock (a virtual ring's, where it is one) and
/// expiring after `timeouts.command`.
///
/// At most two commands to a node are under way. A newer one replaces, joint by joint, what waits: the counter
/// commands_superseded is of joints. A node whose joints are silent gets none: its controller would refuse
/// each, and while that is tried again, for a second, it would hold up the commands to all others.
class CommandIn {
 public:
  /// Whether a node (by id) sends states of its joints; asked on the ring thread.
  using Speaks = std::function<bool(std::uint8_t node)>;

  CommandIn(ros::NodeHandle& nodes, const config::RingConfig& ring, RingPort& port, Speaks speaks, Counters& counters);

  /// Any thread: ends a latched stop of a node; `done` is called once, from the ring thread.
  /// False where the ring thread has too much to do.
  bool resume(std::uint8_t node, RingPort::OnResult done);
  /// Any thread: whether that topic, one of `bridge: {lockstep}`, has a publisher.
  bool has_sender(const std::string& topic) const { return subscribers_.at(topic).getNumPublishers() != 0; }
  /// The full name of that topic.
  std::string resolved(const std::string& topic) const { return subscribers_.at(topic).getTopic(); }
  /// A command, before it is sent on.
  struct Heard {
    std::string topic;   ///< as `bridge: {lockstep}` has it
    std::string sender;  ///< the ROS node
    ros::Time stamp;
  };
  /// Before the port starts: called on the ring thread for each command.
  void on_heard(std::function<void(const Heard&)> handler) { heard_ = std::move(handler); }

 private:
  /// What has been sent to one node and not yet come back, and what waits for that.
  struct NodeCommands {
    unsigned under_way = 0;
    WaitingCommands waiting;
    std::uint16_t sequence = 0;
  };
  using Event = ros::MessageEvent<const sensor_msgs::JointState>;
  void subscribe(ros::NodeHandle& nodes, const std::string& topic);
  void on_command(const std::string& topic, const Event& event);
  /// @param came by the steady clock
  void stamp(payload::JointCommand& command, RingPort::Clock::time_point came);
  void warn_unknown(const std::string& topic, const std::vector<std::string>& names);
  void offer(const CommandSplit::Part& part);
  void send(std::uint8_t node, payload::JointCommand command, RingPort::OnResult done);
  void on_result(std::uint8_t node, const Result& result);

  JointMap joints_;
  std::uint32_t valid_for_us_;
  RingPort& port_;
  Speaks speaks_;
  Counters& counters_;
  std::set<std::string> warned_;
  Throttle refusal_{std::chrono::seconds(1)};
  std::map<std::uint8_t, NodeCommands> by_node_;  // ring thread only
  std::function<void(const Heard&)> heard_ = [](const Heard&) {};
  DirectQueue at_once_;
  std::map<std::string, ros::Subscriber> subscribers_;  ///< by topic
};

}  // namespace limb_ring::bridge
