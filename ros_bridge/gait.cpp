#include "ros_bridge/gait.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace limb_ring::bridge {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kGrow = 2.0;  // s until the full amplitude

struct Share {
  double lift_left, lift_right, sway, swing;
};

// Signs are iCub's: a lifted leg bends hip forward, knee and ankle back.
const std::map<std::string, Share>& shares() {
  static const std::map<std::string, Share> table = {
      {"l_hip_pitch", {0.25, 0, 0, 0}},      {"r_hip_pitch", {0, 0.25, 0, 0}},
      {"l_knee", {-0.50, 0, 0, 0}},          {"r_knee", {0, -0.50, 0, 0}},
      {"l_ankle_pitch", {-0.25, 0, 0, 0}},   {"r_ankle_pitch", {0, -0.25, 0, 0}},
      {"l_hip_roll", {0, 0, -0.06, 0}},      {"r_hip_roll", {0, 0, 0.06, 0}},
      {"l_ankle_roll", {0, 0, 0.06, 0}},     {"r_ankle_roll", {0, 0, -0.06, 0}},
      {"torso_roll", {0, 0, 0.04, 0}},       {"torso_yaw", {0, 0, 0, 0.05}},
      {"l_shoulder_pitch", {0, 0, 0, 0.20}}, {"r_shoulder_pitch", {0, 0, 0, -0.20}},
      {"l_elbow", {0, 0, 0, 0.10}},          {"r_elbow", {0, 0, 0, -0.10}},
  };
  return table;
}

// From 0 to 1, with no kink at either end.
double grown(double time) {
  const double x = std::clamp(time / kGrow, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

// The raised half of a sine, squared: the foot leaves and meets the ground at rest.
double lift(double sine) { return sine > 0 ? sine * sine : 0; }

}  // namespace

Gait::Gait(const config::RingConfig& ring, double step) : step_(step) {
  if (!(step >= 0.8 && step <= 10))
    throw std::invalid_argument("a step of " + std::to_string(step) + " s; it must be 0.8 to 10 s");
  std::size_t used = 0;
  for (const auto& node : ring.nodes)
    for (const auto& joint : node.joints) {
      const auto found = shares().find(joint.name);
      const Share share = found == shares().end() ? Share{} : found->second;
      used += found != shares().end();
      joints_.push_back({joint, share.lift_left, share.lift_right, share.sway, share.swing});
    }
  if (used != shares().size())
    throw std::invalid_argument(ring.path + " has " + std::to_string(used) + " of the " +
                                std::to_string(shares().size()) +
                                " joints walking needs (l_hip_pitch, l_knee ...: see "
                                "config/humanoid16.yaml)");
}

std::vector<Gait::Target> Gait::at(double time) const {
  const double sine = std::sin(2 * kPi * time / step_);
  const double amplitude = grown(time);
  std::vector<Target> targets;
  for (const Joint& joint : joints_) {
    const double offset =
        joint.lift_left * lift(sine) + joint.lift_right * lift(-sine) + (joint.sway + joint.swing) * sine;
    targets.push_back({joint.config.name,
                       std::clamp(joint.config.initial + amplitude * offset, joint.config.lower, joint.config.upper)});
  }
  return targets;
}

}  // namespace limb_ring::bridge
