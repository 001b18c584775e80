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

}  // namespace limb_ring::firmware
