// A robot stays on: the daemon's clock a century after its start.
#include "node/node_driver.h"

#include <gtest/gtest.h>

namespace limb_ring::runtime {
namespace {

using namespace std::chrono_literals;
using Steady = Clock::Steady;

constexpr std::chrono::nanoseconds kCentury = 100 * 365 * 24h;
const Steady::time_point kStart{5s};

TEST(Clock, CountsPicosecondsFromItsStartForACentury) {
  const Clock clock(kStart);
  for (const auto up : {std::chrono::nanoseconds(1), std::chrono::nanoseconds(106 * 24h + 19h), kCentury}) {
    EXPECT_EQ(clock.at(kStart + up) - core::Time{}, core::Duration(up));
    EXPECT_EQ(clock.steady(core::Time{} + up), kStart + up + 1ns) << "never before its time";
  }
}

TEST(Clock, NowIsACenturyAfterAStartACenturyAgo) {
  const Clock clock(Steady::now() - kCentury);
  EXPECT_GE(clock.now() - core::Time{}, core::Duration(kCentury));
}

TEST(Clock, ATimerBeyondTheRangeOfASteadyClockIsForItsEnd) {
  const Clock clock(kStart);
  EXPECT_EQ(clock.steady(core::kNever), Steady::time_point::max());
  EXPECT_EQ(clock.steady(core::Time{} + 300 * 365 * 24h), Steady::time_point::max());
  EXPECT_LT(clock.steady(core::Time{} + 200 * 365 * 24h), Steady::time_point::max());
}

}  // namespace
}  // namespace limb_ring::runtime
