#include "node/steering.h"

#include <gtest/gtest.h>

#include <limits>

namespace limb_ring::virtual_host {
namespace {

using namespace std::chrono_literals;

const Pace::Real kStart{100s};

core::Time at(std::chrono::nanoseconds since_start) { return core::Time{} + since_start; }

TEST(Pace, VirtualTimeRunsAtTheGivenPace) {
  Pace pace(10, kStart);
  EXPECT_EQ(pace.allowed(kStart, at(0s)), at(0s));
  EXPECT_EQ(pace.allowed(kStart + 1ms, at(0s)), at(10ms));
  EXPECT_EQ(pace.when(at(10ms)), kStart + 1ms);
}

TEST(Pace, ARingThatIsALittleBehindCatchesUp) {
  Pace pace(1, kStart);
  EXPECT_EQ(pace.allowed(kStart + 1s, at(1s - 50ms)), at(1s));
  EXPECT_EQ(pace.lost(), 0ns);
}

TEST(Pace, ARingThatIsFarBehindDoesNotCatchUpWithAllOfIt) {
  Pace pace(1, kStart);
  EXPECT_EQ(pace.allowed(kStart + 5s, at(1s)), at(1s + Pace::kMostBehind));
  EXPECT_EQ(pace.lost(), 4s - Pace::kMostBehind);
  EXPECT_EQ(pace.allowed(kStart + 6s, at(2s)), at(2s + Pace::kMostBehind)) << "counted once";
  EXPECT_EQ(pace.lost(), 4s - Pace::kMostBehind);
}

TEST(Pace, TellsHowLateTheRingIs) {
  const Pace pace(2, kStart);
  EXPECT_EQ(pace.late(kStart + 1s, at(2s)), 0ns);
  EXPECT_EQ(pace.late(kStart + 1s, at(1s)), 500ms);
  EXPECT_EQ(pace.late(kStart, at(1s)), 0ns) << "it is early";
  EXPECT_EQ(Pace(std::numeric_limits<double>::infinity(), kStart).late(kStart + 1h, at(0s)), 0ns);
}

TEST(Pace, WaitsForNeverForYears) {
  Pace pace(0.001, kStart);
  EXPECT_GT(pace.when(core::kNever), kStart + 24h * 365);
}

TEST(Pace, WithoutALimitNothingWaits) {
  Pace pace(std::numeric_limits<double>::infinity(), kStart);
  EXPECT_EQ(pace.allowed(kStart, at(1h)), core::kNever);
  EXPECT_LT(pace.when(at(24h)), kStart);
}

}  // namespace
}  // namespace limb_ring::virtual_host
