#include "tools/firmware/joint.h"

#include <gtest/gtest.h>

namespace limb_ring::firmware {
namespace {

using namespace std::chrono_literals;

constexpr nanoseconds kStart = 100s;

Joint joint(config::JointConfig::Safe safe) {
  config::JointConfig config;
  config.safe = safe;
  config.initial = 0.25;
  return {config, config::Firmware{}, 200ms, kStart};
}

ServoTarget velocity(double value) {
  ServoTarget target;
  target.velocity = value;
  return target;
}

TEST(Joint, StartsInItsSafeState) {
  auto holding = joint(config::JointConfig::Safe::hold);
  EXPECT_EQ(holding.state(), Joint::State::hold);
  EXPECT_EQ(joint(config::JointConfig::Safe::damp).state(), Joint::State::damp);
  holding.advance(kStart + 10s);
  EXPECT_DOUBLE_EQ(holding.servo().position(), 0.25);
}

TEST(Joint, ObeysUntilTheCommandTimesOutAndNoLonger) {
  auto moving = joint(config::JointConfig::Safe::hold);
  moving.command(velocity(1), kStart);
  moving.advance(kStart + 199999us);
  EXPECT_EQ(moving.state(), Joint::State::commanded);
  moving.advance(kStart + 200ms);
  EXPECT_EQ(moving.state(), Joint::State::hold);
}

TEST(Joint, GoesOnAsLongAsCommandsCome) {
  auto moving = joint(config::JointConfig::Safe::hold);
  for (auto t = kStart; t < kStart + 1s; t += 150ms) moving.command(velocity(1), t);
  EXPECT_EQ(moving.state(), Joint::State::commanded);
  EXPECT_GT(moving.servo().position(), 1.0);
}

TEST(Joint, HoldsThePositionItHadWhenTheCommandTimedOut) {
  auto moving = joint(config::JointConfig::Safe::hold);
  moving.command(velocity(1), kStart);
  moving.advance(kStart + 200ms);
  const double there = moving.servo().position();
  EXPECT_GT(there, 0.4);
  moving.advance(kStart + 1200ms);
  EXPECT_NEAR(moving.servo().position(), there, 1e-4);
  EXPECT_NEAR(moving.servo().velocity(), 0, 1e-4);
}

TEST(Joint, LetsGoWithDampingWhereItIsConfiguredSo) {
  auto moving = joint(config::JointConfig::Safe::damp);
  moving.command(velocity(1), kStart);
  moving.advance(kStart + 200ms);
  EXPECT_EQ(moving.state(), Joint::State::damp);
  const double there = moving.servo().position();
  moving.advance(kStart + 1200ms);
  EXPECT_GT(moving.servo().position(), there);  // it coasted; nothing pulled it back
  EXPECT_NEAR(moving.servo().velocity(), 0, 1e-6);
  EXPECT_DOUBLE_EQ(moving.servo().effort(), 0);
}

TEST(Joint, AfterAFreezeHasNotMovedOnUnderAnOldCommand) {
  auto frozen = joint(config::JointConfig::Safe::hold);
  auto running = joint(config::JointConfig::Safe::hold);
  frozen.command(velocity(1), kStart);
  running.command(velocity(1), kStart);
  for (auto t = kStart; t <= kStart + 10s; t += 10ms) running.advance(t);
  frozen.advance(kStart + 10s);  // one step over ten seconds
  EXPECT_EQ(frozen.state(), Joint::State::hold);
  EXPECT_NEAR(frozen.servo().position(), running.servo().position(), 1e-3);
}

TEST(Joint, IgnoresTimeThatRunsBackwards) {
  auto moving = joint(config::JointConfig::Safe::hold);
  moving.command(velocity(1), kStart);
  moving.advance(kStart + 100ms);
  const double there = moving.servo().position();
  moving.advance(kStart);
  EXPECT_DOUBLE_EQ(moving.servo().position(), there);
}

}  // namespace
}  // namespace limb_ring::firmware
