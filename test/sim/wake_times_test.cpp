#include "sim/delay_line.h"

#include <gmock/gmock.h>

namespace limb_ring::sim {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

std::vector<unsigned> at(const WakeTimes& times, Time when) {
  std::vector<unsigned> nodes;
  times.each_at(when, [&](unsigned node) { nodes.push_back(node); });
  return nodes;
}

TEST(WakeTimes, KnowTheEarliest) {
  WakeTimes times(5);
  EXPECT_EQ(times.earliest(), core::kNever);
  times.set(3, Time(7ns));
  times.set(1, Time(5ns));
  EXPECT_EQ(times.earliest(), Time(5ns));
  times.set(1, core::kNever);
  EXPECT_EQ(times.earliest(), Time(7ns));
  EXPECT_EQ(times[3], Time(7ns));
}

TEST(WakeTimes, NameAllNodesOfATimeLowestFirst) {
  WakeTimes times(6);
  for (const unsigned node : {5u, 0u, 2u}) times.set(node, Time(4ns));
  times.set(1, Time(9ns));
  EXPECT_THAT(at(times, Time(4ns)), ElementsAre(0, 2, 5));
}

}  // namespace
}  // namespace limb_ring::sim
