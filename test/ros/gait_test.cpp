#include "ros_bridge/gait.h"

#include <gmock/gmock.h>

#include <cmath>

#include "config/load_ring.h"
#include "ros/small_robot.h"

namespace limb_ring::bridge {
namespace {

const config::RingConfig& humanoid() {
  static const auto ring = config::load_ring(LIMB_RING_CONFIG_DIR "/humanoid16.yaml");
  return ring;
}

std::vector<config::JointConfig> joints() {
  std::vector<config::JointConfig> all;
  for (const auto& node : humanoid().nodes) all.insert(all.end(), node.joints.begin(), node.joints.end());
  return all;
}

double position(const Gait& gait, double time, const std::string& joint) {
  for (const auto& target : gait.at(time))
    if (target.joint == joint) return target.position;
  ADD_FAILURE() << joint << " is not moved";
  return 0;
}

TEST(Walking, StartsFromTheStandingPose) {
  const auto start = Gait(humanoid(), 1.6).at(0);
  const auto all = joints();
  ASSERT_EQ(start.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(start[i].position, all[i].initial);
}

TEST(Walking, StaysWithinAnglesAndSpeedsOfEveryJoint) {
  for (const double step : {0.8, 1.6, 10.0}) {
    const Gait gait(humanoid(), step);
    const auto all = joints();
    constexpr double kTick = 0.001;
    for (double time = 0; time < 3 * step + 3; time += kTick) {
      const auto now = gait.at(time), next = gait.at(time + kTick);
      for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_GE(now[i].position, all[i].lower) << all[i].name;
        EXPECT_LE(now[i].position, all[i].upper) << all[i].name;
        EXPECT_LE(std::abs(next[i].position - now[i].position), all[i].velocity * kTick)
            << all[i].name << " at " << time << " s of a step of " << step << " s";
      }
    }
  }
}

TEST(Walking, LiftsTheLegsInTurn) {
  const Gait gait(humanoid(), 1.6);
  const double left_up = 3 * 1.6 + 0.4, right_up = 3 * 1.6 + 1.2;
  EXPECT_LT(position(gait, left_up, "l_knee"), position(gait, left_up, "r_knee") - 0.4);
  EXPECT_LT(position(gait, right_up, "r_knee"), position(gait, right_up, "l_knee") - 0.4);
}

TEST(Walking, NeedsLegsAndAStepOfHumanLength) {
  EXPECT_THROW(Gait(small_robot(), 1.6), std::invalid_argument);
  EXPECT_THROW(Gait(humanoid(), 0.1), std::invalid_argument);
  EXPECT_THROW(Gait(humanoid(), std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace limb_ring::bridge
