#include "comparison/measurements.h"

#include "comparison/test/network_fixture.h"
#include "study/model_ring.h"

namespace limb_ring::study {
namespace {

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

// 16 d + 96 ns = 8.288 us where nothing is in the way.
TEST(InterruptRoundTrips, EmbeddedStayWithinTheirBound) {
  const Latencies all = interrupt_round_trips(kMedium, true, kSeed);
  EXPECT_GE(all.min(), 8288ns);
  EXPECT_LE(all.max(), 16 * (512ns + 160ns));
}

TEST(InterruptRoundTrips, EmbeddedBehindOddBytesStayWithinTheirsToo) {
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

}  // namespace
}  // namespace limb_ring::study
