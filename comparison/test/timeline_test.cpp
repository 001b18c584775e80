#include "comparison/measurements.h"

#include "comparison/test/network_fixture.h"

namespace limb_ring::study {
namespace {

constexpr unsigned kNodes = 16;
const Medium kTimedRing = gigabit(kNodes);
constexpr Duration T = 8ns * (512 + 12);

// The header is passed on in the instant in which it arrives, d after it left; the tail T behind it.
TEST(Timeline, AloneThePacketIsPassedOnWhileItArrives) {
  const Timeline timeline = timeline_alone(kTimedRing);
  ASSERT_EQ(timeline.ours.size(), kNodes + 1u);
  for (unsigned h = 0; h <= kNodes; ++h) {
    const Passing& at = timeline.ours[h];
    EXPECT_EQ(at.hop, h);
    EXPECT_EQ(at.arrives.has_value(), h > 0);
    EXPECT_EQ(at.leaves.has_value(), h < kNodes);
    for (const auto& span : {at.arrives, at.leaves}) {
      if (!span) continue;
      EXPECT_EQ(span->header, h * d) << h;
      EXPECT_EQ(span->tail, T + h * d) << h;
    }
  }
  EXPECT_TRUE(timeline.in_front.empty());
}

// 17 bytes at 80 ns: T = 1.36 us; the last word of the payload is not whole.
TEST(Timeline, OddBytesAndOtherRatesCountToo) {
  Medium slow = gigabit(3, 5);
  slow.rate = 100'000'000;
  const Timeline timeline = timeline_alone(slow);
  for (unsigned h = 1; h <= 3; ++h) EXPECT_EQ(timeline.ours[h].arrives->tail, 1360ns + h * d) << h;
}

// At every node it waits for a whole packet: after h hops it is in after h (T + d), and goes on T later.
TEST(Timeline, AtWorstThePacketWaitsForAnotherAtEveryNode) {
  const Timeline timeline = timeline_worst(kTimedRing);
  for (unsigned h = 1; h <= kNodes; ++h) {
    EXPECT_EQ(timeline.ours[h].arrives->header, h * (T + d) - T) << h;
    EXPECT_EQ(timeline.ours[h].arrives->tail, h * (T + d)) << h;
  }
  for (unsigned h = 1; h < kNodes; ++h) EXPECT_EQ(timeline.ours[h].leaves->header, h * (T + d)) << h;
}

// Node k starts its own as our header arrives, at k (T + d) - T. In front of ours pass it and those of the
// k - 1 nodes before it: 1 + 2 + ... + 15 = 120 in all.
TEST(Timeline, AtWorstWhatGoesInFrontIsTheNodesOwnAndWhatItRelays) {
  const Timeline timeline = timeline_worst(kTimedRing);
  EXPECT_EQ(timeline.in_front.size(), 120u);
  for (const Passing& passing : timeline.in_front) {
    const unsigned node = passing.node(kTimedRing);
    EXPECT_EQ(node, passing.source + passing.hop) << "none of them has passed node 0";
    EXPECT_LE(passing.leaves->tail, timeline.ours[node].leaves->header);
    if (passing.hop != 0) continue;
    EXPECT_EQ(passing.leaves->header, node * (T + d) - T);
    EXPECT_EQ(passing.leaves->tail, node * (T + d));
  }
}

}  // namespace
}  // namespace limb_ring::study
