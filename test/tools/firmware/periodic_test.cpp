#include "client/node_cpu.h"

#include <gtest/gtest.h>

namespace limb_ring::firmware {
namespace {

using namespace std::chrono_literals;

int taken_at(Periodic& periodic, nanoseconds now) {
  int taken = 0;
  while (periodic.take(now)) ++taken;
  return taken;
}

TEST(Periodic, ComesOncePerDeadline) {
  Periodic periodic(100, 1s);
  EXPECT_FALSE(periodic.take(1s + 10ms - 1ns));
  const auto due = periodic.take(1s + 11ms);
  ASSERT_TRUE(due);
  EXPECT_EQ(due->at, 1s + 10ms);
  EXPECT_FALSE(periodic.take(1s + 11ms));
  EXPECT_EQ(periodic.due(), 1s + 20ms);
}

TEST(Periodic, KeepsToTheMultiplesOfItsPeriodWheneverItBegins) {
  EXPECT_EQ(Periodic(100, 1s + 3ms).due(), 1s + 10ms);
  EXPECT_EQ(Periodic(100, 1s + 9'999'999ns).due(), 1s + 10ms);
}

TEST(Periodic, DoesNotDriftWhenItIsServedLate) {
  Periodic periodic(100, 0s);
  int taken = 0;
  for (auto t = 0ms; t <= 10s; t += 3ms) taken += taken_at(periodic, t);
  EXPECT_EQ(taken, 999);  // 1000 deadlines; the last one is at 10 s, after the last call
  EXPECT_EQ(periodic.left_out(), 0U);
}

TEST(Periodic, MakesUpForTheLastEightDeadlines) {
  Periodic periodic(100, 0s);
  EXPECT_EQ(taken_at(periodic, 85ms), 8);
  EXPECT_EQ(periodic.left_out(), 0U);
  EXPECT_EQ(periodic.due(), 90ms);
}

TEST(Periodic, MakesUpForThirtyTwoMillisecondsIfThatIsMore) {
  Periodic periodic(1000, 0s);
  EXPECT_EQ(taken_at(periodic, 40500us), 32);
  EXPECT_EQ(periodic.left_out(), 8U);
}

TEST(Periodic, LeavesOutAndCountsTheOnesBefore) {
  Periodic periodic(100, 0s);
  const auto due = periodic.take(115ms);  // due at 10, 20 ... 110 ms
  ASSERT_TRUE(due);
  EXPECT_EQ(due->left_out, 3U);
  EXPECT_EQ(due->at, 40ms);
  EXPECT_EQ(taken_at(periodic, 115ms), 7);
  EXPECT_EQ(periodic.left_out(), 3U);
  EXPECT_EQ(periodic.due(), 120ms);
}

}  // namespace
}  // namespace limb_ring::firmware
