#pragma once

#include <geometry_msgs/WrenchStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/throttle.h"
#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/sensor_reading.h"
#include "ros_bridge/conversions.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/ring_port.h"
#include "ros_bridge/topic_in.h"

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

/// `joint_commands` from ROS, and the other topics of `bridge: {lockstep}`, spread over the nodes that own the joints:
/// channel 2, priority 0, stamped with the wall clock (on a virtual ring, with the ring's clock) and expiring after
/// `timeouts.command`. CommandSender sends them.
class CommandIn {
 public:
  CommandIn(ros::NodeHandle& nodes, const config::RingConfig& ring, RingPort& port, CommandSender::Speaks speaks,
            Counters& counters);

  /// Any thread: ends a latched stop of a node; `done` is called once, from the ring thread.
  /// False if the ring thread has too much to do.
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
  using Event = ros::MessageEvent<const sensor_msgs::JointState>;
  void subscribe(ros::NodeHandle& nodes, const std::string& topic);
  void on_command(const std::string& topic, const Event& event);
  /// @param came by the steady clock
  void stamp(payload::JointCommand& command, RingPort::Clock::time_point came);
  void warn_unknown(const std::string& topic, const std::vector<std::string>& names);
  void warn_not_given(const std::string& topic, const std::vector<std::string>& names);

  JointMap joints_;
  std::uint32_t valid_for_us_;
  RingPort& port_;
  Counters& counters_;
  CommandSender sender_;  ///< ring thread only
  std::set<std::string> warned_;
  process::Throttle refusal_{std::chrono::seconds(1)}, not_given_{std::chrono::seconds(1)};
  std::function<void(const Heard&)> heard_ = [](const Heard&) {};
  DirectQueue at_once_;
  std::map<std::string, ros::Subscriber> subscribers_;  ///< by topic
};

/// Values of sensors from ROS: the entry `topic` of a sensor in the ring's file. Each goes to the node that has the
/// sensor, on channel 2 at the sensor's priority; its CPU sends it on as a reading (client/node_cpu.h). At most `rate`
/// a second, and one of each sensor under way: a value that comes sooner is left out, and counted. (ours)
class SensorIn {
 public:
  SensorIn(ros::NodeHandle& nodes, const config::RingConfig& ring, RingPort& port, Counters& counters);

 private:
  /// Ring thread only, except for const members.
  struct Source {
    const std::uint8_t node;
    const std::uint8_t priority;
    const RingPort::Clock::duration period;
    payload::SensorReading next;  ///< without its values
    bool under_way = false;
    RingPort::Clock::time_point not_before{};
  };

  template <typename Message>
  ros::Subscriber subscribe(ros::NodeHandle& nodes, const std::string& topic, Source& source);
  void take(Source& source, const std::array<double, 3>& linear, const std::array<double, 3>& angular);
  void send(Source& source);

  RingPort& port_;
  Counters& counters_;
  std::deque<Source> sources_;
  DirectQueue at_once_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace limb_ring::bridge
