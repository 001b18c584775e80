#pragma once

#include <geometry_msgs/WrenchStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/JointState.h>

#include <array>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "io/throttle.h"
#include "limb_ring/payload/sensor_reading.h"
#include "ros_bridge/command_sender.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/ring_port.h"
#include "ros_bridge/topic_in.h"

namespace limb_ring::bridge {

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
