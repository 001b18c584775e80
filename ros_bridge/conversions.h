#pragma once

#include <geometry_msgs/WrenchStamped.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/JointState.h>

#include <cstdint>
#include <string>
#include <vector>

#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/sensor_reading.h"
#include "ros_bridge/joint_map.h"
#include "ros_bridge/joint_store.h"

namespace limb_ring::bridge {

/// One command of the robot, taken apart for the nodes that own its joints.
struct CommandSplit {
  struct Part {
    std::uint8_t node;  ///< id
    payload::JointCommand command;
  };
  std::vector<Part> parts;             ///< in ring order, nodes with a commanded joint only
  std::vector<std::string> unknown;    ///< joints that no node owns, fit to be printed
  std::vector<std::string> not_given;  ///< joints of ours that are named, and all that is said of them is NaN
};

/// Stamp, sequence and validity are left for the sender to set: ROS time may be simulated.
/// A value that is NaN counts as not given, as ros_control has it: the others are obeyed.
/// @throw std::invalid_argument where nothing of it may be obeyed: no names, an array that is
///        neither empty nor as long as `name`, a value that is infinite, a joint named twice.
CommandSplit split_command(const sensor_msgs::JointState& message, const JointMap& joints);

sensor_msgs::JointState to_joint_state(const std::vector<JointStore::Joint>& joints, ros::Time stamp);

/// Covariances are unknown, orientation is not given (first covariance -1). (REP 145)
sensor_msgs::Imu to_imu(const payload::SensorReading& reading, ros::Time stamp, const std::string& frame);
geometry_msgs::WrenchStamped to_wrench(const payload::SensorReading& reading, ros::Time stamp,
                                       const std::string& frame);

}  // namespace limb_ring::bridge
