#include "tools/firmware/simulated_sensor.h"

#include <cmath>

namespace limb_ring::firmware {
namespace {

constexpr double kGravity = 9.80665;  // m/s^2
constexpr double kLever = 0.4;        // m

void fill_imu(payload::SensorReading& reading, const Limb& limb) {
  double pitch = 0, rate = 0;
  for (const auto& joint : limb.joints()) {
    if (joint.slides()) continue;
    pitch += joint.servo().position();
    rate += joint.servo().velocity();
  }
  reading.kind = payload::SensorReading::Kind::imu;
  reading.linear = {-kGravity * std::sin(pitch), 0, kGravity * std::cos(pitch)};
  reading.angular = {0, rate, 0};
}

void fill_force(payload::SensorReading& reading, const Limb& limb) {
  const bool slides = !limb.joints().empty() && limb.joints().back().slides();
  const double effort = limb.joints().empty() ? 0 : limb.joints().back().servo().effort();
  reading.kind = payload::SensorReading::Kind::force;
  reading.linear = {0, 0, slides ? effort : effort / kLever};
  reading.angular = {0, slides ? 0 : effort, 0};
}

}  // namespace

SimulatedSensor::SimulatedSensor(const config::SensorConfig& sensor, std::uint8_t index, nanoseconds start)
    : kind_(sensor.kind), priority_(sensor.priority), index_(index), periodic_(sensor.rate, start) {}

payload::SensorReading SimulatedSensor::sample(const Limb& limb, const Timestamps& now) {
  payload::SensorReading reading;
  if (kind_ == config::SensorConfig::Kind::imu)
    fill_imu(reading, limb);
  else
    fill_force(reading, limb);
  reading.sequence = sequence_++;
  reading.stamp_ns = now.wall_ns;
  reading.sensor = index_;
  return reading;
}

}  // namespace limb_ring::firmware
