#include "comparison/measurements.h"
#include "comparison/test/network_fixture.h"
#include "study/model_ring.h"

namespace limb_ring::study {
namespace {

std::vector<Duration> limits(const std::vector<Bin>& bins) {
  std::vector<Duration> out{bins.front().from};
  for (const Bin& bin : bins) out.push_back(bin.to);
  return out;
}

std::vector<std::size_t> counts(const std::vector<Bin>& bins) {
  std::vector<std::size_t> out;
  for (const Bin& bin : bins) out.push_back(bin.count);
  return out;
}

TEST(Histogram, OfNothingIsEmpty) { EXPECT_TRUE(histogram({}, 10ns).empty()); }

// 11 and 20 lie in (10, 20], 21 in (20, 30], none in (30, 40], 41 in (40, 50].
TEST(Histogram, CountsEveryValueOnceAndLeavesNoGap) {
  const auto bins = histogram({41ns, 20ns, 11ns, 21ns}, 10ns);
  EXPECT_THAT(limits(bins), testing::ElementsAre(10ns, 20ns, 30ns, 40ns, 50ns));
  EXPECT_THAT(counts(bins), testing::ElementsAre(2u, 1u, 0u, 1u));
}

TEST(Histogram, ValueAtALimitIsInTheBinThatEndsThere) {
  const auto bins = histogram({10ns}, 10ns);
  EXPECT_THAT(limits(bins), testing::ElementsAre(0ns, 10ns));
}

const Medium kMedium = gigabit(16);
constexpr std::uint64_t kSeed = 5;

// T + 16 d = 12.384 us alone; 16 (T + d) = 75.264 us at worst.
TEST(DataRoundTrips, LieBetweenAloneAndTheBound) {
  const Latencies all = data_round_trips(kMedium, 0.9, kSeed);
  EXPECT_GT(all.count(), 10'000u);
  EXPECT_EQ(all.min(), 12384ns);
  EXPECT_LE(all.max(), 75264ns);
}

// Ten times the load, ten times as many packets: each is counted once. The numbers are rounded to whole ones.
TEST(DataRoundTrips, AreAsManyAsTheLoadOffers) {
  const auto few = static_cast<double>(data_round_trips(kMedium, 0.05, kSeed).count());
  const auto many = static_cast<double>(data_round_trips(kMedium, 0.5, kSeed).count());
  EXPECT_NEAR(many, 10 * few, 10);
}

TEST(DataRoundTrips, DependOnTheSeedAlone) {
  const Medium small = gigabit(4, 64);
  const Latencies first = data_round_trips(small, 0.7, 1);
  EXPECT_EQ(first.values(), data_round_trips(small, 0.7, 1).values());
  EXPECT_NE(first.values(), data_round_trips(small, 0.7, 2).values());
}

// 16 d + 96 ns = 8.288 us if nothing is in the way.
TEST(InterruptRoundTrips, EmbeddedStayWithinTheirBound) {
  const Latencies all = interrupt_round_trips(kMedium, true, kSeed);
  EXPECT_GE(all.min(), 8288ns);
  EXPECT_LE(all.max(), 16 * (512ns + 160ns));
}

TEST(InterruptRoundTrips, EmbeddedBehindOddBytesStayWithinTheirBoundToo) {
  const Medium odd = gigabit(8, 3);
  EXPECT_LE(interrupt_round_trips(odd, true, kSeed).max(), interrupt_bound(odd));
}

// Some of 15 relays are in the middle of a packet of 4.192 us: on the way round an interrupt waits longer
// than the embedded one's bound as a rule, never longer than for a whole packet at each.
TEST(InterruptRoundTrips, BetweenPacketsTakeFarLongerYetKeepTheirBound) {
  const Latencies all = interrupt_round_trips(kMedium, false, kSeed);
  EXPECT_GT(all.quantile(0.5), 16 * (512ns + 160ns));
  EXPECT_LE(all.max(), 16 * (512ns + 96ns + 4192ns));
}

TEST(InterruptRoundTrips, BetweenPacketsKeepTheirBoundInSmallRingsToo) {
  for (const unsigned payload : {1u, 16u, 512u}) {
    const Medium medium = gigabit(3, payload);
    EXPECT_LE(interrupt_round_trips(medium, false, kSeed).max(), interrupt_bound_between_packets(medium)) << payload;
  }
}

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
TEST(Timeline, AtWorstTheNodesOwnPacketAndRelayedOnesGoFirst) {
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
