#pragma once

#include <geometry_msgs/WrenchStamped.h>
#include <limb_ring/NodeStatus.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "config/node_row.h"
#include "config/ring_config.h"
#include "limb_ring/host_port.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"

namespace limb_ring::bridge {

/// Which node owns which joint, by the ring's configuration.
class JointMap {
 public:
  struct Place {
    std::size_t node;   ///< in ring order
    std::size_t joint;  ///< in the node's configured order
  };

  explicit JointMap(const config::RingConfig& ring);
  std::optional<Place> find(const std::string& joint) const;
  std::uint8_t id(std::size_t node) const { return ids_[node]; }
  std::size_t joints(std::size_t node) const { return counts_[node]; }
  std::size_t nodes() const { return ids_.size(); }
  /// The joint that this one follows without a motor of its own; empty: it follows none.
  std::string leader_of(const std::string& joint) const;
  /// All joints, separated by commas.
  const std::string& names() const { return names_; }

 private:
  std::vector<std::uint8_t> ids_;
  std::vector<std::size_t> counts_;
  std::unordered_map<std::string, Place> places_;
  std::unordered_map<std::string, std::string> leaders_;
  std::string names_;
};

/// The newest state of every node's joints, and which of them can still be believed.
///
/// A node is silent when no state of it has come for three state periods, and for longer than the machine may pause a
/// process. Its joints are then listed as silent, and their last state is not shown. Time is an argument.
class JointStore {
 public:
  using Clock = std::chrono::steady_clock;

  struct Joint {
    std::string name;
    payload::JointState::Joint state;
  };
  struct Sample {
    std::uint8_t node;
    std::int64_t stamp_ns;
  };
  struct Snapshot {
    std::vector<Joint> fresh;          ///< in the configuration's order, then those that follow them
    std::int64_t oldest_stamp_ns = 0;  ///< of the samples in `fresh`; wall clock
    std::vector<Sample> samples;       ///< that `fresh` is made of
    std::vector<std::string> silent;   ///< joints left out
  };
  /// What has come from one node.
  struct Received {
    std::uint64_t states = 0;
    std::uint64_t missing = 0;  ///< left out in the sequence of states, restarts not counted
    std::uint64_t refused = 0;  ///< commands that its CPU did not obey, as its states count them
    bool stopped = false;       ///< a stop interrupt is latched there
  };

  explicit JointStore(const config::RingConfig& ring);

  /// @return false if the node is not configured, or has another number of joints.
  bool take(std::uint8_t node, const payload::JointState& state, Clock::time_point now);
  /// The connection to the ring was lost: every node is silent until its next state comes.
  void forget();
  /// @param pause how long the machine may suspend a process; 0 if the ring's time waits for all processes
  Snapshot snapshot(Clock::time_point now, Clock::duration pause = {}) const;
  Received received(std::uint8_t node) const;
  /// The node owns joints, and they are not silent.
  bool speaks(std::uint8_t node, Clock::time_point now, Clock::duration pause = {}) const;

 private:
  struct Node {
    std::vector<std::string> joints;
    bool heard = false;
    Clock::time_point arrived{};
    payload::JointState state;
    Received received;
  };
  bool is_fresh(const Node& node, Clock::time_point now, Clock::duration pause) const;
  void add_followers(Snapshot& snapshot) const;

  Clock::duration silence_;
  std::vector<std::uint8_t> order_;
  std::map<std::uint8_t, Node> nodes_;
  std::vector<config::FollowerConfig> followers_;
};

/// One command of the robot, taken apart for the nodes that own its joints.
struct CommandSplit {
  struct Part {
    std::uint8_t node;  ///< id
    payload::JointCommand command;
  };
  std::vector<Part> parts;             ///< in ring order, nodes with a commanded joint only
  std::vector<std::string> unknown;    ///< joints that no node owns, fit to be printed
  std::vector<std::string> not_given;  ///< known joints that are named with NaN as their only values
};

/// Stamp, sequence and validity are left for the sender to set: ROS time may be simulated.
/// A value that is NaN counts as not given, as in ros_control; the other values are obeyed.
/// @throw std::invalid_argument if the whole command must be refused: no names, an array that is
///        neither empty nor as long as `name`, a value that is infinite, a joint named twice.
CommandSplit split_command(const sensor_msgs::JointState& message, const JointMap& joints);

sensor_msgs::JointState to_joint_state(const std::vector<JointStore::Joint>& joints, ros::Time stamp);

/// Covariances are unknown, orientation is not given (first covariance -1). (REP 145)
sensor_msgs::Imu to_imu(const payload::SensorReading& reading, ros::Time stamp, const std::string& frame);
geometry_msgs::WrenchStamped to_wrench(const payload::SensorReading& reading, ros::Time stamp,
                                       const std::string& frame);

/// A node about which nothing is known: state "down".
NodeStatus unheard_node(const config::NodeConfig& node);

/// Fills in the node's own row.
void merge_status_row(const status::NodeRow& row, NodeStatus& status);

/// Fills in what another node has heard in this node's beacons. If the node's own row is missing, but its last beacon
/// is at most `fresh` old, its state is `up`.
void merge_beacon(const status::Heard& heard, std::chrono::milliseconds fresh, NodeStatus& status);

/// A member of a daemon's answer, if it is a whole number.
inline std::int64_t number_of(const nlohmann::json& said, const char* member, std::int64_t otherwise) {
  const auto found = said.find(member);
  return found != said.end() && found->is_number_integer() ? found->get<std::int64_t>() : otherwise;
}

/// An outcome as one word, for counters and messages: "no_such_node".
inline std::string outcome_word(std::string outcome) {
  std::replace(outcome.begin(), outcome.end(), ' ', '_');
  return outcome;
}
inline std::string outcome_word(Outcome outcome) { return outcome_word(to_string(outcome)); }

}  // namespace limb_ring::bridge
