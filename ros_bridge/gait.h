#pragma once

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
  /// @throw std::invalid_argument where `step` is not 0.8 to 10, or a leg joint is missing
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

}  // namespace limb_ring::bridge
