#pragma once

#include <optional>
#include <string>
#include <vector>

#include "limb_ring/joint_node.h"

namespace limb_ring::firmware {

/// One simulated joint drive (ours): an inertia moved by a motor with limited torque, under a
/// controller that makes it a second-order system of the configured natural frequency and damping.
///
///   driven:   acceleration = w^2 (position - x) + 2 z w (velocity - v) + effort / inertia
///             a term without a target is left out; a velocity not given is 0
///   torque:   effort only: the motor gives that torque, against viscous friction 2 z w inertia
///   released: no torque; friction lets the velocity decay
///
/// The torque is limited, then the speed, then the position: at its stop a joint stands still. A joint that slides is
/// the same with a mass and forces, in m, m/s and N.
struct ServoModel {
  double bandwidth = 8.0;              ///< Hz, natural frequency w / 2 pi
  double damping = 0.9;                ///< damping ratio z
  double lower = -3.14, upper = 3.14;  ///< rad
  double velocity = 6.0;               ///< rad/s, limit both ways
  double effort = 50.0;                ///< N m, limit both ways
  double initial = 0.0;                ///< rad
  double inertia = 0.1;                ///< kg m^2: a forearm's, roughly; of what slides kg
};

/// What a servo is to do. An empty one means nothing (see Servo::release()).
struct ServoTarget {
  std::optional<double> position;  ///< rad
  std::optional<double> velocity;  ///< rad/s
  std::optional<double> effort;    ///< N m, added to the controller's
};

class Servo {
 public:
  explicit Servo(const ServoModel& model);

  /// Values beyond the joint's limits are cut to them.
  void drive(const ServoTarget& target);
  void release();
  /// Goes on by `seconds` (>= 0), in substeps that are stable whatever the model. More than one
  /// second at once counts as one: by then a servo has settled.
  void step(double seconds);

  double position() const { return position_; }  ///< rad
  double velocity() const { return velocity_; }  ///< rad/s
  double effort() const { return effort_; }      ///< N m, of the motor in the last substep

 private:
  bool controlled() const { return target_.position || target_.velocity; }
  void substep(double h);
  double unlimited_velocity(double h) const;
  void move(double h);

  ServoModel model_;
  double stiffness_;  // w^2, 1/s^2
  double damping_;    // 2 z w, 1/s
  ServoTarget target_;
  double position_;
  double velocity_ = 0;
  double effort_ = 0;
};

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
