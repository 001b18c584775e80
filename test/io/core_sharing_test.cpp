#include "io/packet_loop.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>

#include "io/on_one_core.h"

namespace limb_ring::event_loop {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Time = YieldTimes::Time;

/// `time` after the begin of a period, long after the machine's start.
Time at(YieldTimes::Duration time) { return Time{} + 1000 * YieldTimes::kPeriod + time; }

TEST(YieldTimes, AllSleepAtTheBeginOfAPeriod) {
  YieldTimes times;
  EXPECT_FALSE(times.due(at(milliseconds(0)), true));
  EXPECT_FALSE(times.due(at(YieldTimes::kSleepFor) - Time::duration(1), true));
  EXPECT_TRUE(times.due(at(YieldTimes::kSleepFor), true));
  times.was_useful(at(YieldTimes::kPeriod));
  EXPECT_FALSE(times.due(at(YieldTimes::kPeriod), true));
}

TEST(YieldTimes, IsGivenUpForAPeriodIfItIsInVain) {
  YieldTimes times;
  ASSERT_TRUE(times.due(at(milliseconds(10)), true));
  times.was_useful(at(milliseconds(12)));
  EXPECT_TRUE(times.due(at(milliseconds(12) + YieldTimes::kPatience - milliseconds(1)), true));
  EXPECT_FALSE(times.due(at(milliseconds(12) + YieldTimes::kPatience), true));
  EXPECT_FALSE(times.due(at(YieldTimes::kPeriod - milliseconds(1)), true));
  EXPECT_TRUE(times.due(at(YieldTimes::kPeriod + YieldTimes::kSleepFor), true));
}

TEST(YieldTimes, IsOnceAPeriodIfItIsNotUseful) {
  YieldTimes times;
  EXPECT_TRUE(times.due(at(milliseconds(0)), false));
  times.was_useful(at(milliseconds(1)));
  EXPECT_FALSE(times.due(at(milliseconds(2)), false));
  EXPECT_TRUE(times.due(at(YieldTimes::kPeriod), false));
}

TEST(YieldTimes, PausesIfSomethingComputesTwiceAsLongEachTime) {
  YieldTimes times;
  const auto slow = YieldTimes::kLongestRound + milliseconds(1);
  Time now = at(milliseconds(10));
  times.came_back(now, now + YieldTimes::kLongestRound);
  EXPECT_TRUE(times.alone(now + YieldTimes::kLongestRound));

  for (auto pause = YieldTimes::kFirstPause; pause < 2 * YieldTimes::kLongestPause; pause *= 2) {
    times.came_back(now, now + slow);
    now += slow + std::min(pause, YieldTimes::kLongestPause);
    EXPECT_FALSE(times.alone(now - Time::duration(1)));
    EXPECT_FALSE(times.due(now - Time::duration(1), true));
    EXPECT_TRUE(times.alone(now));
  }
}

TEST(YieldTimes, APauseLongAgoIsForgotten) {
  YieldTimes times;
  const auto slow = YieldTimes::kLongestRound + milliseconds(1);
  const Time first = at(milliseconds(10)), second = first + seconds(60);
  times.came_back(first, first + slow);
  times.came_back(second, second + slow);
  EXPECT_FALSE(times.alone(second + slow + YieldTimes::kFirstPause - Time::duration(1)));
  EXPECT_TRUE(times.alone(second + slow + YieldTimes::kFirstPause));
}

/// `time` after the begin of a period that is some seconds ahead on the machine's clock: so no call takes long.
Time ahead(YieldTimes::Duration time) {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  static const auto next = now - now % YieldTimes::kPeriod + 100 * YieldTimes::kPeriod;
  return Time{} + next + time;
}

struct CoreSharingOnOneCore : OnOneCore {
  CoreSharing sharing;

  void SetUp() override {
    OnOneCore::SetUp();
    if (::sched_getscheduler(0) != SCHED_OTHER) GTEST_SKIP() << "these tests do not run under SCHED_OTHER";
  }
};

TEST_F(CoreSharingOnOneCore, InterruptsNobodyWhilePacketsPass) {
  sharing.begin();
  EXPECT_EQ(::sched_getscheduler(0), SCHED_OTHER);
  sharing.let_others_run(ahead(milliseconds(10)), false);
  EXPECT_EQ(::sched_getscheduler(0), SCHED_BATCH);
  EXPECT_TRUE(sharing.have_run());
  sharing.after_turn(ahead(milliseconds(10)), true);
  EXPECT_FALSE(sharing.have_run());
  sharing.end();
  EXPECT_EQ(::sched_getscheduler(0), SCHED_OTHER);
}

TEST_F(CoreSharingOnOneCore, SleepsAtTheBeginOfAPeriod) {
  sharing.begin();
  sharing.let_others_run(ahead(milliseconds(0)), false);
  EXPECT_FALSE(sharing.have_run());
  sharing.end();
}

TEST_F(CoreSharingOnOneCore, SleepsIfAnAnswerIsDueButOnceAPeriod) {
  sharing.begin();
  sharing.let_others_run(ahead(milliseconds(10)), true);
  EXPECT_TRUE(sharing.have_run());
  sharing.after_turn(ahead(milliseconds(10)), true);
  sharing.let_others_run(ahead(milliseconds(11)), true);
  EXPECT_FALSE(sharing.have_run());
  sharing.let_others_run(ahead(milliseconds(12)), false);
  EXPECT_TRUE(sharing.have_run());
  sharing.end();
}

TEST_F(CoreSharingOnOneCore, KeepsThePolicyItWasGiven) {
  const sched_param ordinary{};
  ASSERT_EQ(::sched_setscheduler(0, SCHED_BATCH, &ordinary), 0);
  sharing.begin();
  sharing.let_others_run(ahead(milliseconds(10)), false);
  EXPECT_TRUE(sharing.have_run());
  sharing.end();
  EXPECT_EQ(::sched_getscheduler(0), SCHED_BATCH);
  ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
}

TEST_F(CoreSharingOnOneCore, LetsOthersRunOnceAPeriodIfThereAreCoresToChooseFrom) {
  if (CPU_COUNT(&before) == 1) GTEST_SKIP() << "there is one core";
  ASSERT_EQ(::sched_setaffinity(0, sizeof before, &before), 0);
  sharing.begin();
  sharing.let_others_run(ahead(milliseconds(10)), false);
  EXPECT_TRUE(sharing.have_run());
  EXPECT_EQ(::sched_getscheduler(0), SCHED_BATCH);
  sharing.after_turn(ahead(milliseconds(11)), true);
  sharing.let_others_run(ahead(milliseconds(12)), false);
  EXPECT_FALSE(sharing.have_run());
  sharing.end();
  EXPECT_EQ(::sched_getscheduler(0), SCHED_OTHER);
}

}  // namespace
}  // namespace limb_ring::event_loop
