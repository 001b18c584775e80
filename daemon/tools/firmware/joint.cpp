#include "tools/firmware/joint.h"

namespace limb_ring::firmware {
namespace {

constexpr double kSlidingMass = 5;  // kg

ServoModel model_of(const config::JointConfig& joint, const config::Firmware& firmware) {
  ServoModel model;
  model.bandwidth = firmware.bandwidth;
  model.damping = firmware.damping;
  model.lower = joint.lower;
  model.upper = joint.upper;
  model.velocity = joint.velocity;
  model.effort = joint.effort;
  model.initial = joint.initial;
  if (joint.slides()) model.inertia = kSlidingMass;
  return model;
}

Joint::State safe_state(const config::JointConfig& joint) {
  return joint.safe == config::JointConfig::Safe::damp ? Joint::State::damp : Joint::State::hold;
}

}  // namespace

Joint::Joint(const config::JointConfig& joint, const config::Firmware& firmware, nanoseconds command_timeout,
             nanoseconds now)
    : servo_(model_of(joint, firmware)),
      safe_(safe_state(joint)),
      state_(safe_),
      slides_(joint.slides()),
      command_timeout_(command_timeout),
      now_(now) {
  go_safe();
}

void Joint::command(const ServoTarget& target, nanoseconds now) {
  advance(now);
  servo_.drive(target);
  state_ = State::commanded;
  commanded_until_ = now + command_timeout_;
}

void Joint::go_safe() {
  state_ = safe_;
  if (safe_ == State::damp) return servo_.release();
  ServoTarget here;
  here.position = servo_.position();
  servo_.drive(here);
}

void Joint::advance(nanoseconds now) {
  if (state_ == State::commanded && now >= commanded_until_) {
    step_to(commanded_until_);
    go_safe();
  }
  step_to(now);
}

void Joint::step_to(nanoseconds time) {
  if (time <= now_) return;
  servo_.step(std::chrono::duration<double>(time - now_).count());
  now_ = time;
}

}  // namespace limb_ring::firmware
