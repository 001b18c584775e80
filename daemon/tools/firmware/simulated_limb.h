#pragma once

#include <string>
#include <vector>

#include "limb_ring/joint_node.h"
#include "tools/firmware/servo.h"

namespace limb_ring::firmware {

/// The joints of a node as simulated servos, and its sensors made up from them (ours): plausible, repeatable, and
/// moving when they move. Not a model of the body's dynamics.
///
///   imu:    gravity seen from a link pitched by the sum of the joints' angles, and their summed
///           velocity as turn rate about y; joints that slide do not pitch it
///   force:  the torque of the last joint about y, and its force over a lever of 0.4 m along z; of one that slides its
///           force alone
class SimulatedLimb {
 public:
  explicit SimulatedLimb(const NodeSetup& setup);

  std::vector<JointNode::Joint> step(double dt, const std::vector<JointGoal>& goals);
  SensorValues measure(bool imu) const;

 private:
  SensorValues imu() const;
  SensorValues force() const;

  std::vector<Servo> servos_;
  std::vector<bool> slides_;
};

/// A sensor as a file has recorded it: rows "TIME, X, Y, Z, X, Y, Z", s and what SensorValues holds, times ascending; a
/// heading is left out. (ours)
class RecordedSensor {
 public:
  /// @throw std::runtime_error naming file, line and what would be right
  explicit RecordedSensor(const std::string& path);
  /// The last row up to that time after the first one, s; behind the last row from the beginning again.
  const SensorValues& at(double time) const;

 private:
  std::vector<double> times_;  ///< from the first row
  std::vector<SensorValues> values_;
};

}  // namespace limb_ring::firmware
