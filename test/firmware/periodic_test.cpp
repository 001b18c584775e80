#include "firmware/periodic.h"

#include <gtest/gtest.h>

namespace limb_ring::firmware {
namespace {

using namespace std::chrono_literals;

TEST(Periodic, ComesOncePerDeadline) {
  Periodic periodic(100, 1s);
  EXPECT_FALSE(periodic.take(1s + 10ms - 1ns));
  EXPECT_TRUE(periodic.take(1s + 10ms));
  EXPECT_FALSE(periodic.take(1s + 10ms));
  EXPECT_EQ(periodic.due(), 1s + 20ms);
}

TEST(Periodic, DoesNotDriftWhenItIsServedLate) {
  Periodic periodic(100, 0s);
  int taken = 0;
  for (auto t = 0ms; t <= 10s; t += 3ms) taken += periodic.take(t) ? 1 : 0;
  EXPECT_EQ(taken, 999);  // 1000 deadlines; the last one is at 10 s, past the last poll
  EXPECT_EQ(periodic.missed(), 0U);
}

TEST(Periodic, LeavesOutAndCountsWhatItMissedAltogether) {
  Periodic periodic(100, 0s);
  EXPECT_TRUE(periodic.take(55ms));  // due at 10, 20, 30, 40 and 50 ms
  EXPECT_EQ(periodic.missed(), 4U);
  EXPECT_EQ(periodic.due(), 60ms);
}

}  // namespace
}  // namespace limb_ring::firmware
