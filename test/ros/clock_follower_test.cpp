#include "ros_bridge/clock_follower.h"

#include <gtest/gtest.h>

#include <random>

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
constexpr std::int64_t kMs = 1'000'000, kSecond = 1000 * kMs;

class OuterTimeTest : public testing::Test {
 protected:
  /// What the ring's time may reach after that, ns; each jump back is counted.
  std::int64_t take(std::int64_t time_ns) {
    if (const auto step = outer.next(time_ns)) {
      outer.allowed(*step);
      jumps += step->jumped_back;
      until_ns = step->until_ns();
    }
    return until_ns;
  }
  OuterTime outer;
  int jumps = 0;
  std::int64_t until_ns = -1;
};

TEST_F(OuterTimeTest, BeginsAtTheFirstAndFollows) {
  EXPECT_FALSE(outer.has_begun());
  EXPECT_EQ(take(1000 * kSecond), 0);
  EXPECT_TRUE(outer.has_begun());
  EXPECT_EQ(take(1002 * kSecond), 2 * kSecond);
}

// A ring that took each step back for a jump would be at some 21 s.
TEST_F(OuterTimeTest, AClockThatJittersGivesNoMoreTimeThanItsOwn) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int64_t> noise(-5 * kMs, 5 * kMs);
  take(1000 * kSecond);
  for (std::int64_t t = 0; t <= 10 * kSecond; t += kMs) take(1000 * kSecond + t + noise(random));
  EXPECT_EQ(jumps, 0);
  EXPECT_GE(until_ns, 10 * kSecond - 5 * kMs);
  EXPECT_LE(until_ns, 10 * kSecond + 5 * kMs);
}

TEST_F(OuterTimeTest, GoesOnFromWhereItIsAfterAJumpBack) {
  take(1000 * kSecond);
  take(1004 * kSecond);
  EXPECT_EQ(take(5 * kSecond), 4 * kSecond);
  EXPECT_EQ(take(6 * kSecond), 5 * kSecond);
  EXPECT_EQ(jumps, 1);
}

TEST_F(OuterTimeTest, ATimeThatTheDaemonRefusesCountsAsNeverGiven) {
  take(1000 * kSecond);
  outer.next(9000 * kSecond);
  EXPECT_EQ(take(1001 * kSecond), kSecond);
  EXPECT_EQ(jumps, 0);
}

TEST_F(OuterTimeTest, TakesOverARingThatRunsAndLeavesOneThatBeginsAnew) {
  outer.take_over(7 * kSecond, 3 * kSecond);
  EXPECT_EQ(take(11 * kSecond), 4 * kSecond);
  outer.take_over(0, 9 * kSecond);  // it is known already
  EXPECT_EQ(take(12 * kSecond), 5 * kSecond);
  outer.take_over(0, 0);
  EXPECT_FALSE(outer.has_begun());
  EXPECT_EQ(take(5 * kSecond), 0);
}

TEST(ClockPublisher, FollowsTheFirstOneUntilItIsSilent) {
  ClockPublisher publisher;
  const ClockPublisher::Clock::time_point now{1h};
  EXPECT_TRUE(publisher.is("/gazebo", now));
  EXPECT_FALSE(publisher.is("/play", now + 1999ms));
  EXPECT_TRUE(publisher.is("/gazebo", now + 1999ms));
  EXPECT_FALSE(publisher.is("/play", now + 3s));
  EXPECT_TRUE(publisher.is("/play", now + 4s));
  EXPECT_FALSE(publisher.is("/gazebo", now + 4s));
  EXPECT_EQ(publisher.name(), "/play");
}

}  // namespace
}  // namespace limb_ring::bridge
