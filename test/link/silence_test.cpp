#include "link/silence.h"

#include <gtest/gtest.h>

namespace limb_ring::link {
namespace {

using std::chrono::seconds;

struct SilenceAt10And50 : testing::Test {
  Time now{seconds(100)};
  Silence silence{Timing{}};
  SilenceAt10And50() { silence.restart(now); }
  bool tick(milliseconds after) { return silence.tick(now += after); }
};

TEST_F(SilenceAt10And50, IsCalledAfterFiveQuietTicks) {
  EXPECT_FALSE(tick(milliseconds(10)));  // the tick of the last sign of life
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(tick(milliseconds(10))) << i;
  EXPECT_TRUE(tick(milliseconds(10)));
}

TEST_F(SilenceAt10And50, IsBrokenByASign) {
  for (int i = 0; i < 5; ++i) tick(milliseconds(10));
  silence.heard();
  EXPECT_FALSE(tick(milliseconds(10)));
  EXPECT_FALSE(tick(milliseconds(10)));
}

TEST_F(SilenceAt10And50, IsNotBlamedOnOthersByWhoWasAsleepItself) {
  tick(milliseconds(10));
  EXPECT_FALSE(tick(seconds(5)));
}

TEST_F(SilenceAt10And50, IsOverWhereALastReadBringsSomething) {
  for (int i = 0; i < 5; ++i) tick(milliseconds(10));
  ASSERT_TRUE(tick(milliseconds(10)));
  EXPECT_TRUE(silence.still());
  silence.heard();
  EXPECT_FALSE(silence.still());
}

}  // namespace
}  // namespace limb_ring::link
