#include "client/command_filter.h"

#include <limits>

#include <gtest/gtest.h>

namespace limb_ring::firmware {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kWall = 1'700'000'000'000'000'000;

/// The instant `t` after the test's start, on both clocks.
Timestamps at(nanoseconds t) { return {50s + t, kWall + t.count()}; }

/// A command given at `t`, valid for 100 ms.
payload::JointCommand given(nanoseconds t, std::uint16_t sequence = 1) {
  payload::JointCommand command;
  command.sequence = sequence;
  command.stamp_ns = at(t).wall_ns;
  command.valid_for_us = 100000;
  return command;
}

payload::JointCommand resume(nanoseconds t) {
  auto command = given(t);
  command.resume = true;
  return command;
}

class CommandFilterTest : public testing::Test {
 protected:
  CommandFilter filter{200ms};
};

TEST_F(CommandFilterTest, ObeysACommandUntilItExpires) {
  EXPECT_EQ(filter.judge(given(0ms), at(100ms)), Verdict::obey);
  EXPECT_EQ(filter.judge(given(1ms), at(101ms + 1ns)), Verdict::expired);
}

TEST_F(CommandFilterTest, RefusesAStampFurtherAheadThanItIsValidFor) {
  EXPECT_EQ(filter.judge(given(100ms + 1ns), at(0ms)), Verdict::early);
  EXPECT_EQ(filter.judge(given(100ms), at(0ms)), Verdict::obey);
}

TEST_F(CommandFilterTest, RefusesWhatIsOlderThanTheLastObeyed) {
  EXPECT_EQ(filter.judge(given(10ms, 5), at(20ms)), Verdict::obey);
  EXPECT_EQ(filter.judge(given(9ms, 6), at(20ms)), Verdict::older);
  EXPECT_EQ(filter.judge(given(11ms, 4), at(20ms)), Verdict::obey);  // a commander started again
}

TEST_F(CommandFilterTest, OrdersEqualStampsBySequenceAcrossItsWrap) {
  EXPECT_EQ(filter.judge(given(10ms, 0xFFFF), at(20ms)), Verdict::obey);
  EXPECT_EQ(filter.judge(given(10ms, 0xFFFF), at(20ms)), Verdict::older);
  EXPECT_EQ(filter.judge(given(10ms, 0xFFFE), at(20ms)), Verdict::older);
  EXPECT_EQ(filter.judge(given(10ms, 0), at(20ms)), Verdict::obey);
}

TEST_F(CommandFilterTest, ARefusedCommandDoesNotMoveTheOrder) {
  EXPECT_EQ(filter.judge(given(90ms), at(0ms)), Verdict::obey);
  EXPECT_EQ(filter.judge(given(300ms), at(0ms)), Verdict::early);
  EXPECT_EQ(filter.judge(given(91ms), at(1ms)), Verdict::obey);
}

/// The same instant after this host's wall clock was set, forwards or back.
Timestamps stepped(nanoseconds t, nanoseconds step) {
  Timestamps now = at(t);
  now.wall_ns += step.count();
  return now;
}

TEST_F(CommandFilterTest, ObeysAcrossAStepOfThisHostsWallClock) {
  for (const nanoseconds step : std::initializer_list<nanoseconds>{2s, -2s, 30ms, -30ms}) {
    CommandFilter one{200ms};
    EXPECT_EQ(one.judge(given(0ms), at(1ms)), Verdict::obey);
    EXPECT_EQ(one.judge(given(10ms), stepped(11ms, step)), Verdict::obey) << "stamped before the step";
    EXPECT_EQ(one.judge(given(9ms), stepped(11ms, step)), Verdict::older);
    auto command = given(20ms);
    command.stamp_ns += step.count();
    EXPECT_EQ(one.judge(command, stepped(21ms, step)), Verdict::obey) << "stamped after it";
    EXPECT_EQ(one.judge(command, stepped(21ms, step)), Verdict::older);
  }
}

TEST_F(CommandFilterTest, AStepOfTheWallClockResumesNothing) {
  filter.judge(given(0ms), at(0ms));
  filter.stop(at(10ms));
  EXPECT_EQ(filter.judge(resume(9ms), stepped(11ms, 2s)), Verdict::stopped);
  auto command = resume(20ms);
  command.stamp_ns -= nanoseconds(2s).count();
  EXPECT_EQ(filter.judge(command, stepped(21ms, -2s)), Verdict::obey);
}

TEST_F(CommandFilterTest, ForgetsTheFormerWallClockAfterASecond) {
  filter.judge(given(0ms), at(0ms));
  EXPECT_EQ(filter.judge(given(10ms), stepped(11ms, 2s)), Verdict::obey);
  EXPECT_EQ(filter.judge(given(1020ms), stepped(1020ms, 2s)), Verdict::expired);
}

TEST_F(CommandFilterTest, IsNotLockedOutByAnotherHostsWallClockSetBack) {
  EXPECT_EQ(filter.judge(given(0ms), at(0ms)), Verdict::obey);
  const auto one_hour = std::int64_t{3600} * 1'000'000'000;
  auto command = given(50ms);
  command.stamp_ns -= one_hour;
  command.valid_for_us = 4'000'000'000;
  EXPECT_EQ(filter.judge(command, at(50ms)), Verdict::older);
  EXPECT_EQ(filter.judge(command, at(200ms)), Verdict::obey);
}

TEST_F(CommandFilterTest, HandlesEveryStampAndValidity) {
  auto command = given(0ms);
  command.stamp_ns = std::numeric_limits<std::int64_t>::max();
  command.valid_for_us = 0xFFFFFFFF;
  EXPECT_EQ(filter.judge(command, at(0ms)), Verdict::early);
  command.stamp_ns = 0;
  EXPECT_EQ(filter.judge(command, at(0ms)), Verdict::expired);
  command.stamp_ns = at(0ms).wall_ns;
  command.valid_for_us = 0;
  EXPECT_EQ(filter.judge(command, at(0ms)), Verdict::obey);
}

TEST_F(CommandFilterTest, HoldsAStopUntilACommandResumes) {
  filter.stop(at(0ms));
  EXPECT_TRUE(filter.stopped());
  EXPECT_EQ(filter.judge(given(10ms), at(10ms)), Verdict::stopped);
  EXPECT_TRUE(filter.stopped());
  EXPECT_EQ(filter.judge(resume(20ms), at(20ms)), Verdict::obey);
  EXPECT_FALSE(filter.stopped());
  EXPECT_EQ(filter.judge(given(30ms), at(30ms)), Verdict::obey);
}

TEST_F(CommandFilterTest, IsNotResumedByACommandGivenBeforeTheStop) {
  filter.stop(at(10ms));
  EXPECT_EQ(filter.judge(resume(10ms), at(20ms)), Verdict::stopped);
  EXPECT_EQ(filter.judge(resume(10ms + 1ns), at(20ms)), Verdict::obey);
}

TEST_F(CommandFilterTest, IsNotResumedByAnExpiredCommand) {
  filter.stop(at(0ms));
  EXPECT_EQ(filter.judge(resume(10ms), at(500ms)), Verdict::expired);
  EXPECT_TRUE(filter.stopped());
}

}  // namespace
}  // namespace limb_ring::firmware
