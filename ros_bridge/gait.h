#pragma once

#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "config/ring_config.h"

namespace limb_ring::bridge {

/// Walking in place, for the demo (ours): the legs are lifted in turn, the trunk sways over the
/// standing leg, the arms swing. Sines around the configured standing pose, grown from it within
/// the first two seconds, and never outside a joint's limits. No balance, no dynamics.
class Gait {
 public:
  struct Target {
    std::string joint;
    double position;  ///< rad
  };

  /// `step` in s is the time of a left and a right step.
  /// @throw std::invalid_argument if `step` is not 0.8 to 10, or a leg joint is missing
  Gait(const config::RingConfig& ring, double step);

  /// All joints of the ring, `time` s after the start (0: the standing pose).
  std::vector<Target> at(double time) const;

 private:
  struct Joint {
    config::JointConfig config;
    double lift_left, lift_right, sway, swing;  ///< rad at the full amplitude of each
  };
  std::vector<Joint> joints_;
  double step_;
};

/// The last known angle of every joint. `joint_states` leaves out silent joints, and a limb without a joint state would
/// vanish from the picture of the robot instead of being shown as down.
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
