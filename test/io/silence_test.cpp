#include "io/input.h"

#include <gtest/gtest.h>

namespace limb_ring::link {
namespace {

using std::chrono::seconds;

struct SuspensionOf60 : testing::Test {
  Suspension suspension{true, milliseconds(60)};
  nanoseconds boot{seconds(500)}, monotonic{seconds(100)};
  SuspensionOf60() { suspension.noticed(boot, monotonic); }
  bool noticed() { return suspension.noticed(boot, monotonic); }
};

TEST_F(SuspensionOf60, IsNoticedOnce) {
  boot += milliseconds(60);
  EXPECT_TRUE(noticed());
  EXPECT_FALSE(noticed());
}

TEST_F(SuspensionOf60, IsNotNoticedIfItWasShorter) {
  boot += milliseconds(59);
  EXPECT_FALSE(noticed());
}

TEST_F(SuspensionOf60, IsNotAPauseBetweenTheTwoReadings) {
  monotonic += seconds(1);
  EXPECT_FALSE(noticed());
  boot += seconds(1);
  EXPECT_FALSE(noticed());
}

TEST_F(SuspensionOf60, IsNothingIfAllNodesAreOnThatHost) {
  suspension = {false, milliseconds(60)};
  noticed();
  boot += seconds(9);
  EXPECT_FALSE(noticed());
}

struct SilenceAt20And60 : testing::Test {
  Time now{seconds(100)};
  Silence silence{Timing{milliseconds(20), milliseconds(60)}};
  SilenceAt20And60() { silence.restart(now); }
  bool tick(milliseconds after) { return silence.tick(now += after); }
};

TEST_F(SilenceAt20And60, IsCalledAfterThreeQuietTicks) {
  EXPECT_FALSE(tick(milliseconds(20)));  // the tick of the last sign of life
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(tick(milliseconds(20))) << i;
  EXPECT_TRUE(tick(milliseconds(20)));
}

TEST_F(SilenceAt20And60, IsBrokenByASign) {
  for (int i = 0; i < 3; ++i) tick(milliseconds(20));
  silence.heard();
  EXPECT_FALSE(tick(milliseconds(20)));
  EXPECT_FALSE(tick(milliseconds(20)));
}

TEST_F(SilenceAt20And60, IsNotBlamedOnOthersByAProcessThatWasNotScheduled) {
  tick(milliseconds(20));
  EXPECT_FALSE(tick(seconds(5)));
}

TEST_F(SilenceAt20And60, KnowsThatThisEndStoodStillUntilItsNextTick) {
  tick(milliseconds(20));
  EXPECT_FALSE(silence.stood_still(now + milliseconds(59)));
  EXPECT_TRUE(silence.stood_still(now + milliseconds(60)));
  tick(milliseconds(60));
  EXPECT_FALSE(silence.stood_still(now));
}

TEST_F(SilenceAt20And60, IsOverIfALastReadBringsSomething) {
  for (int i = 0; i < 3; ++i) tick(milliseconds(20));
  ASSERT_TRUE(tick(milliseconds(20)));
  EXPECT_TRUE(silence.still());
  silence.heard();
  EXPECT_FALSE(silence.still());
}

}  // namespace
}  // namespace limb_ring::link
