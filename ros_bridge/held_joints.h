#pragma once

#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <map>
#include <string>

#include "config/ring_config.h"

namespace limb_ring::bridge {

/// The last known angle of every joint: `joint_states` leaves out what is silent, and a limb without a
/// joint state would vanish from the picture of the robot instead of showing that it is down.
class HeldJoints {
 public:
  /// Before anything has come: the angles the joints start with.
  explicit HeldJoints(const config::RingConfig& ring) {
    for (const auto& node : ring.nodes)
      for (const auto& joint : node.joints) angles_[joint.name] = joint.initial;
  }

  void take(const sensor_msgs::JointState& message) {
    const std::size_t count = std::min(message.name.size(), message.position.size());
    for (std::size_t i = 0; i < count; ++i) angles_[message.name[i]] = message.position[i];
  }

  sensor_msgs::JointState all(ros::Time stamp) const {
    sensor_msgs::JointState message;
    message.header.stamp = stamp;
    for (const auto& [name, angle] : angles_) {
      message.name.push_back(name);
      message.position.push_back(angle);
    }
    return message;
  }

 private:
  std::map<std::string, double> angles_;
};

}  // namespace limb_ring::bridge
