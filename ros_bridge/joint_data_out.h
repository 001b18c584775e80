#pragma once

#include <ros/ros.h>

#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ros_bridge/conversions.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/ring_port.h"

namespace limb_ring::bridge {

/// Joint states and sensor readings from the ring to ROS: `joint_states` at a set rate, of all
/// joints that are not silent; `states/NODE` (only while it has subscribers) and `sensors/NAME` as each
/// sample comes. Stamps are those of the samples, from the clock of the node that took them.
class JointDataOut {
 public:
  /// @param sample_log path of a file that gets the samples of each `joint_states`; empty: none
  /// @throw std::invalid_argument if that cannot be written
  JointDataOut(ros::NodeHandle& nodes, const config::RingConfig& ring, double rate, RingPort& port, Counters& counters,
               const std::string& sample_log = "");

  /// Any thread: somebody hears `joint_states`.
  bool is_heard() const { return states_.getNumSubscribers() != 0; }
  /// The name of `joint_states`, resolved.
  std::string topic() const { return states_.getTopic(); }
  /// Before the port starts: called on the ring thread before each `joint_states`.
  void before_publishing(std::function<void()> handler) { publishing_ = std::move(handler); }
  /// The same after each, with its stamp.
  void on_published(std::function<void(ros::Time)> handler) { published_ = std::move(handler); }
  /// Any thread: as of the last `joint_states`.
  std::vector<std::string> silent_joints() const;
  /// Any thread: sensors from which nothing has come for three of their periods.
  std::vector<std::string> silent_sensors() const;
  /// Any thread: what is wrong with the packets of that node, in words, as long as it sends such packets; empty:
  /// nothing.
  std::string problem_of(std::uint8_t node) const;
  /// Any thread.
  JointStore::Received received(std::uint8_t node) const;
  /// Ring thread only: the node's joints are not silent.
  bool speaks(std::uint8_t node) const;

 private:
  void on_packet(const Packet& packet);
  void take_state(const Packet& packet);
  void take_reading(const Packet& packet);
  void publish_states();
  std::chrono::milliseconds longest_pause() const;
  void note(const JointStore::Snapshot& snapshot);
  void advertise_samples(ros::NodeHandle& nodes, const config::RingConfig& ring);
  void publish_sample(std::uint8_t node, const payload::JointState& state);

  const config::RingConfig& ring_;
  RingPort& port_;
  Counters& counters_;
  mutable std::mutex mutex_;  // the store and the list are read by the status too
  JointStore store_;
  std::vector<std::string> silent_;
  ros::Publisher states_;
  std::ofstream log_;  ///< closed if there is none
  std::function<void()> publishing_ = [] {};
  std::function<void(ros::Time)> published_ = [](ros::Time) {};
  struct Sensor {
    std::string name, frame;
    ros::Publisher publisher;
    std::chrono::nanoseconds period;
    std::optional<RingPort::Clock::time_point> heard;
  };
  /// A packet that does not fit the ring's file: counted, said once in the log for each kind, and shown for a while.
  void refuse(std::uint8_t node, const char* counter, const std::string& why);
  struct Unfit {
    std::string why;
    RingPort::Clock::time_point at;
  };
  struct Sampled {
    std::vector<std::string> joints;
    ros::Publisher states;
    std::vector<Sensor> sensors;
  };
  std::map<std::uint8_t, Sampled> sampled_;  // by node
  std::map<std::uint8_t, Unfit> unfit_;      ///< the last of each node
  std::set<std::pair<std::uint8_t, std::string>> said_;
};

}  // namespace limb_ring::bridge
