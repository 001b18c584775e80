#include "tools/firmware/simulated_limb.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "config/quantity.h"

namespace limb_ring::firmware {
namespace {

constexpr double kGravity = 9.80665;  // m/s^2
constexpr double kLever = 0.4;        // m
constexpr double kSlidingMass = 5;    // kg

ServoModel model_of(const NodeJoint& joint, const NodeSetup& setup) {
  ServoModel model;
  model.bandwidth = setup.bandwidth;
  model.damping = setup.damping;
  model.lower = joint.lower;
  model.upper = joint.upper;
  model.velocity = joint.velocity;
  model.effort = joint.effort;
  model.initial = joint.initial;
  if (joint.slides) model.inertia = kSlidingMass;
  return model;
}

}  // namespace

SimulatedLimb::SimulatedLimb(const NodeSetup& setup) {
  for (const NodeJoint& joint : setup.joints) {
    servos_.emplace_back(model_of(joint, setup));
    slides_.push_back(joint.slides);
  }
}

std::vector<JointNode::Joint> SimulatedLimb::step(double dt, const std::vector<JointGoal>& goals) {
  std::vector<JointNode::Joint> joints;
  for (std::size_t i = 0; i < servos_.size(); ++i) {
    Servo& servo = servos_[i];
    if (goals[i].state == JointGoal::State::damp)
      servo.release();
    else
      servo.drive({goals[i].position, goals[i].velocity, goals[i].effort});
    servo.step(dt);
    joints.push_back({servo.position(), servo.velocity(), servo.effort()});
  }
  return joints;
}

SensorValues SimulatedLimb::measure(bool is_imu) const { return is_imu ? imu() : force(); }

SensorValues SimulatedLimb::imu() const {
  double pitch = 0, rate = 0;
  for (std::size_t i = 0; i < servos_.size(); ++i) {
    if (slides_[i]) continue;
    pitch += servos_[i].position();
    rate += servos_[i].velocity();
  }
  return {{-kGravity * std::sin(pitch), 0, kGravity * std::cos(pitch)}, {0, rate, 0}};
}

SensorValues SimulatedLimb::force() const {
  if (servos_.empty()) return {};
  const double effort = servos_.back().effort();
  if (slides_.back()) return {{0, 0, effort}, {}};
  return {{0, 0, effort / kLever}, {0, effort, 0}};
}

namespace {

/// The seven numbers of a row; fewer where something else stands there.
std::vector<double> numbers_of(const std::string& line) {
  std::vector<double> numbers;
  std::istringstream fields(line);
  for (std::string field; std::getline(fields, field, ',');) {
    const std::size_t begin = field.find_first_not_of(" \t\r"), end = field.find_last_not_of(" \t\r");
    const auto number =
        begin == std::string::npos ? std::nullopt : config::parse_real(field.substr(begin, end - begin + 1));
    if (!number) break;
    numbers.push_back(*number);
  }
  return numbers;
}

}  // namespace

RecordedSensor::RecordedSensor(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::vector<double> row = numbers_of(line);
    if (number == 1 && row.empty()) continue;  // a heading
    const bool later = times_.empty() || (!row.empty() && row[0] > times_.back());
    if (row.size() != 7 || !later)
      throw std::runtime_error(
          path + ':' + std::to_string(number) + ": " +
          (row.size() != 7 ? "has " + std::to_string(row.size()) + " numbers" : "goes back in time") +
          "; allowed: time in s, x, y, z, x, y, z, times ascending");
    times_.push_back(row[0]);
    values_.push_back({{row[1], row[2], row[3]}, {row[4], row[5], row[6]}});
  }
  if (times_.empty()) throw std::runtime_error(path + ": has no row; allowed: time in s, x, y, z, x, y, z");
  for (std::size_t i = times_.size(); i-- > 0;) times_[i] -= times_[0];
}

const SensorValues& RecordedSensor::at(double time) const {
  const double within = times_.back() > 0 ? std::fmod(time, times_.back()) : 0;
  const auto next = std::upper_bound(times_.begin(), times_.end(), within);
  return values_[static_cast<std::size_t>(next - times_.begin()) - 1];
}

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
