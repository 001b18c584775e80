#include <gmock/gmock.h>

#include "support/temporary_folder.h"
#include "tools/firmware/firmware_bench.h"

namespace limb_ring::firmware {
namespace {

using namespace bench;
using State = JointGoal::State;

constexpr bool kHolds = false, kDamps = true;

payload::JointCommand::Joint velocity(double value) { return {{}, value, {}}; }

TEST(Joint, StartsInItsSafeState) {
  SimulatedJoint holding(kHolds);
  EXPECT_EQ(holding.state(), State::hold);
  EXPECT_EQ(SimulatedJoint(kDamps).state(), State::damp);
  holding.advance(10s);
  EXPECT_DOUBLE_EQ(holding.joint().position, 0.25);
}

TEST(Joint, ObeysUntilTheCommandTimesOutAndNoLonger) {
  SimulatedJoint moving(kHolds);
  moving.command(velocity(1), 0ms);
  moving.advance(199999us);
  EXPECT_EQ(moving.state(), State::commanded);
  moving.advance(200ms);
  EXPECT_EQ(moving.state(), State::hold);
}

TEST(Joint, GoesOnAsLongAsCommandsCome) {
  SimulatedJoint moving(kHolds);
  for (auto t = 0ms; t < 1s; t += 150ms) moving.command(velocity(1), t);
  EXPECT_EQ(moving.state(), State::commanded);
  EXPECT_GT(moving.joint().position, 1.0);
}

TEST(Joint, HoldsThePositionItHadWhenTheCommandTimedOut) {
  SimulatedJoint moving(kHolds);
  moving.command(velocity(1), 0ms);
  moving.advance(200ms);
  const double there = moving.joint().position;
  EXPECT_GT(there, 0.4);
  EXPECT_EQ(moving.limb.goals()[0].position, there);
  moving.advance(1200ms);
  EXPECT_NEAR(moving.joint().position, there, 1e-4);
  EXPECT_NEAR(moving.joint().velocity, 0, 1e-4);
}

TEST(Joint, LetsGoWithDampingIfItIsConfiguredSo) {
  SimulatedJoint moving(kDamps);
  moving.command(velocity(1), 0ms);
  moving.advance(200ms);
  EXPECT_EQ(moving.state(), State::damp);
  const double there = moving.joint().position;
  moving.advance(1200ms);
  EXPECT_GT(moving.joint().position, there);  // it coasted; nothing pulled it back
  EXPECT_NEAR(moving.joint().velocity, 0, 1e-6);
  EXPECT_DOUBLE_EQ(moving.joint().effort, 0);
}

TEST(Joint, AfterAFreezeHasNotMovedOnUnderAnOldCommand) {
  SimulatedJoint frozen(kHolds), running(kHolds);
  frozen.command(velocity(1), 0ms);
  running.command(velocity(1), 0ms);
  for (auto t = 0ms; t <= 10s; t += 10ms) running.advance(t);
  frozen.advance(10s);  // one step over ten seconds
  EXPECT_EQ(frozen.state(), State::hold);
  EXPECT_NEAR(frozen.joint().position, running.joint().position, 1e-3);
}

TEST(Joint, IgnoresTimeThatRunsBackwards) {
  SimulatedJoint moving(kHolds);
  moving.command(velocity(1), 0ms);
  moving.advance(100ms);
  const double there = moving.joint().position;
  moving.advance(0ms);
  EXPECT_DOUBLE_EQ(moving.joint().position, there);
}

TEST(Joint, HasGoalsWithinItsLimits) {
  SimulatedJoint moving(kHolds);
  moving.command({9, -70, 1000}, 0ms);
  EXPECT_EQ(moving.limb.goals()[0].position, 3.14);
  EXPECT_EQ(moving.limb.goals()[0].velocity, -6);
  EXPECT_EQ(moving.limb.goals()[0].effort, 50);
}

TEST(Joint, ThatSlidesDoesNotPitchTheImu) {
  NodeSetup setup = leg();
  setup.joints.resize(1);
  setup.joints[0].slides = true;
  setup.joints[0].initial = 1;
  SimulatedLimb lift(setup);
  JointGoal goal;
  goal.position = 1.5;
  lift.step(0.01, {goal});
  EXPECT_DOUBLE_EQ(lift.measure(true).linear[0], 0);
  EXPECT_DOUBLE_EQ(lift.measure(false).angular[1], 0);
  EXPECT_GT(lift.measure(false).linear[2], 0) << "the force of its motor";
}

TEST(RecordedSensor, IsPlayedFromItsFileAgainAndAgain) {
  const test::TemporaryFolder folder;
  const RecordedSensor sensor(
      folder.write("imu.csv", "t, x, y, z, x, y, z\n5,1,2,3,4,5,6\n5.5, 7, 8, 9, 1, 2, 3\r\n6,0,0,0,0,0,0\n"));
  EXPECT_EQ(sensor.at(0).linear, (std::array<double, 3>{1, 2, 3}));
  EXPECT_EQ(sensor.at(0.49).angular, (std::array<double, 3>{4, 5, 6}));
  EXPECT_EQ(sensor.at(0.5).linear[0], 7);
  EXPECT_EQ(sensor.at(1.2).linear[0], 1) << "from the beginning again";
  const auto refusal = [&](const std::string& text) -> std::string {
    try {
      RecordedSensor(folder.write("wrong.csv", text));
      return "accepted";
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  };
  EXPECT_THAT(refusal("0,1,2,3,4,5\n"), testing::HasSubstr("wrong.csv:1: has 6 numbers; allowed: time in s, x"));
  EXPECT_THAT(refusal("1,0,0,0,0,0,0\n1,0,0,0,0,0,0\n"), testing::HasSubstr("wrong.csv:2: goes back in time"));
  EXPECT_THAT(refusal("t,x\n"), testing::HasSubstr("has no row"));
}

}  // namespace
}  // namespace limb_ring::firmware
