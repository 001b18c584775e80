#include "tools/firmware/servo.h"

#include <algorithm>
#include <cmath>

namespace limb_ring::firmware {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kSubstep = 0.0005;   // s
constexpr double kLongestStep = 1.0;  // s

double cut(double value, double limit) { return std::clamp(value, -limit, limit); }

}  // namespace

Servo::Servo(const ServoModel& model) : model_(model), position_(model.initial) {
  const double w = 2 * kPi * model.bandwidth;
  stiffness_ = w * w;
  damping_ = 2 * model.damping * w;
}

void Servo::drive(const ServoTarget& target) {
  target_ = target;
  if (target.position) target_.position = std::clamp(*target.position, model_.lower, model_.upper);
  if (target.velocity) target_.velocity = cut(*target.velocity, model_.velocity);
  if (target.effort) target_.effort = cut(*target.effort, model_.effort);
}

void Servo::release() { target_ = {}; }

void Servo::step(double seconds) {
  seconds = std::min(seconds, kLongestStep);
  const int count = static_cast<int>(std::ceil(seconds / kSubstep));
  for (int i = 0; i < count; ++i) substep(seconds / count);
}

/// Implicit in position and velocity, hence stable for every stiffness, damping and step.
double Servo::unlimited_velocity(double h) const {
  double push = target_.effort.value_or(0) / model_.inertia;
  double stiffness = 0;
  if (target_.position) {
    stiffness = stiffness_;
    push += stiffness_ * (*target_.position - position_);
  }
  if (controlled()) push += damping_ * target_.velocity.value_or(0);
  return (velocity_ + h * push) / (1 + h * damping_ + h * h * stiffness);
}

void Servo::substep(double h) {
  const double wanted = unlimited_velocity(h);
  if (controlled()) {
    effort_ = cut((wanted - velocity_) / h * model_.inertia, model_.effort);
    velocity_ += effort_ / model_.inertia * h;
  } else {
    effort_ = target_.effort.value_or(0);
    velocity_ = wanted;
  }
  move(h);
}

void Servo::move(double h) {
  velocity_ = cut(velocity_, model_.velocity);
  position_ += velocity_ * h;
  if (position_ >= model_.lower && position_ <= model_.upper) return;
  position_ = std::clamp(position_, model_.lower, model_.upper);
  velocity_ = 0;
}

}  // namespace limb_ring::firmware
