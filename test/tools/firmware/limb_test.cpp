#include "client/node_cpu.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tools/firmware/firmware_bench.h"

namespace limb_ring::firmware {
namespace {

using namespace bench;

class LimbTest : public testing::Test {
 protected:
  LimbTest() {
    limb.moved_by([this](double dt, const std::vector<JointGoal>& goals) { return servos.step(dt, goals); });
  }
  Verdict give(const payload::JointCommand& command, nanoseconds t) {
    return limb.command(payload::decode_joint_command(view(bytes_of(command))), at(t));
  }

  Limb limb{leg(), true, at(0ms).monotonic};
  SimulatedLimb servos{leg()};
};

TEST_F(LimbTest, SaysThatItIsSafeBeforeTheFirstCommand) {
  const auto state = limb.sample(at(5ms));
  EXPECT_TRUE(state.mode.safe && state.mode.hold && state.mode.damp);
  EXPECT_FALSE(state.mode.commanded || state.mode.stopped || state.mode.command_refused);
  EXPECT_EQ(state.stamp_ns, at(5ms).wall_ns);
  EXPECT_EQ(state.joints.size(), 2U);
}

TEST_F(LimbTest, NumbersItsStates) {
  EXPECT_EQ(limb.sample(at(0ms)).sequence, 0);
  EXPECT_EQ(limb.sample(at(10ms)).sequence, 1);
}

TEST_F(LimbTest, MovesItsJointsWhereTheyAreTold) {
  for (auto t = 0ms; t < 1s; t += 10ms) ASSERT_EQ(give(positions(t, {0.5, -0.25}), t), Verdict::obey);
  const auto state = limb.sample(at(1s));
  EXPECT_NEAR(state.joints[0].position, 0.5, 1e-6);
  EXPECT_NEAR(state.joints[1].position, -0.25, 1e-6);
  EXPECT_TRUE(state.mode.commanded);
  EXPECT_FALSE(state.mode.safe);
}

TEST_F(LimbTest, KeepsEachJointSafeThatIsNotCommanded) {
  for (auto t = 0ms; t < 1s; t += 10ms) give(positions(t, {0.5}), t);
  const auto state = limb.sample(at(1s));
  EXPECT_TRUE(state.mode.commanded && state.mode.safe && state.mode.damp);
  EXPECT_FALSE(state.mode.hold);
  EXPECT_DOUBLE_EQ(state.joints[1].position, 0);
}

TEST_F(LimbTest, GoesSafeWhenCommandsStopComing) {
  give(positions(0ms, {0.5, 0.5}), 0ms);
  EXPECT_TRUE(limb.sample(at(199ms)).mode.commanded);
  const auto state = limb.sample(at(200ms));
  EXPECT_FALSE(state.mode.commanded);
  EXPECT_TRUE(state.mode.safe && state.mode.hold && state.mode.damp);
}

TEST_F(LimbTest, DoesNotActOnAStaleCommandAfterAFreezeAndSaysSo) {
  const auto stale = positions(0ms, {1.0, 1.0});  // waited in the buffer for two seconds
  EXPECT_EQ(give(stale, 2s), Verdict::expired);
  auto state = limb.sample(at(3s));
  EXPECT_DOUBLE_EQ(state.joints[0].position, 0);
  EXPECT_TRUE(state.mode.command_refused && state.mode.safe);
  EXPECT_EQ(state.refused, 1);
  EXPECT_EQ(limb.count(Verdict::expired), 1U);
  state = limb.sample(at(3010ms));
  EXPECT_FALSE(state.mode.command_refused);  // said once
  EXPECT_EQ(state.refused, 1);               // and counted for good
}

TEST_F(LimbTest, StopsAllJointsUntilResumed) {
  give(positions(0ms, {1.0, 1.0}), 0ms);
  limb.stop(at(50ms));
  auto state = limb.sample(at(60ms));
  EXPECT_TRUE(state.mode.stopped && state.mode.safe);
  EXPECT_FALSE(state.mode.commanded);
  EXPECT_EQ(give(positions(70ms, {1.0, 1.0}), 70ms), Verdict::stopped);
  const double there = limb.sample(at(1s)).joints[0].position;
  EXPECT_NEAR(limb.sample(at(2s)).joints[0].position, there, 1e-4);
  auto again = positions(3s, {1.0, 1.0});
  again.resume = true;
  EXPECT_EQ(give(again, 3s), Verdict::obey);
  state = limb.sample(at(3010ms));
  EXPECT_TRUE(state.mode.commanded);
  EXPECT_FALSE(state.mode.stopped || state.mode.safe);
}

TEST_F(LimbTest, StaysSafeAfterAResumeWithoutJoints) {
  limb.stop(at(0ms));
  auto resume = positions(10ms, {});
  resume.resume = true;
  EXPECT_EQ(give(resume, 10ms), Verdict::obey);
  const auto state = limb.sample(at(20ms));
  EXPECT_FALSE(state.mode.stopped || state.mode.commanded);
  EXPECT_TRUE(state.mode.safe);
}

TEST_F(LimbTest, RefusesACommandForMoreJointsThanItHas) {
  EXPECT_EQ(give(positions(0ms, {1, 1, 1}), 0ms), Verdict::unfit);
  EXPECT_DOUBLE_EQ(limb.sample(at(100ms)).joints[0].position, 0);
}

TEST_F(LimbTest, CountsBytesThatAreNoCommand) {
  EXPECT_EQ(limb.command(payload::decode_joint_command(view({2, 1, 0})), at(0ms)), Verdict::malformed);
  EXPECT_EQ(limb.count(Verdict::malformed), 1U);
  EXPECT_TRUE(limb.sample(at(0ms)).mode.command_refused);
}

TEST(Limb, IsMovedOncePerSampleUnlessItIsMovedAtOnce) {
  Limb limb(leg(), false, at(0ms).monotonic);
  std::vector<double> steps;
  limb.moved_by([&](double dt, const std::vector<JointGoal>& goals) {
    steps.push_back(dt);
    return std::vector<Limb::Joint>(goals.size(), Limb::Joint{goals[0].position.value_or(7), 0, 0});
  });
  limb.command(payload::Decoded<payload::JointCommand>(positions(4ms, {0.5})), at(4ms));
  EXPECT_EQ(limb.sample(at(10ms)).joints[0].position, 0.5);
  limb.advance(at(205ms).monotonic);
  EXPECT_EQ(limb.sample(at(210ms)).joints[0].position, 0.5) << "held where it was";
  EXPECT_EQ(steps, (std::vector<double>{0.01, 0.2}));
}

TEST(Limb, SaysWhatIsWrongWithWhatAStepReturns) {
  Limb limb(leg(), false, at(0ms).monotonic);
  const auto refusal = [&](std::vector<Limb::Joint> joints, nanoseconds t) -> std::string {
    limb.moved_by([joints](double, const std::vector<JointGoal>&) { return joints; });
    try {
      limb.sample(at(t));
      return "accepted";
    } catch (const std::logic_error& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refusal({{}}, 10ms),
            "node left_knee: step() returned 1 joints, and the ring's file gives it 2; return one for each, in the "
            "file's order");
  EXPECT_EQ(refusal({{}, {0, std::nan(""), 0}}, 20ms), "node left_knee: step() returned NaN for joint l_ankle_pitch");
}

TEST(Limb, RefusesANodeWithMoreJointsThanAPacketCarries) {
  auto node = leg();
  node.joints.resize(39);
  try {
    Limb limb(node, true, at(0ms).monotonic);
    FAIL() << "39 joints were accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "node 'left_knee' has 39 joints; one packet carries at most 38");
  }
}

}  // namespace
}  // namespace limb_ring::firmware
