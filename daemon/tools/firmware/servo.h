#pragma once

#include <optional>

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

}  // namespace limb_ring::firmware
