// What all methods have in common, and what the comparison makes of them.
#include "comparison/comparison.h"

#include "comparison/buses.h"
#include "comparison/point_to_point.h"
#include "comparison/process_image.h"
#include "comparison/ring_network.h"
#include "comparison/test/network_fixture.h"

namespace limb_ring::study {
namespace {

template <class Method>
struct EveryMethod : testing::Test {};
using Methods = testing::Types<RingNetwork, Arcnet, EtherCat, Sercos, ResponsiveLink, CanBus>;
TYPED_TEST_SUITE(EveryMethod, Methods);

// A model that delivers twice throws.
TYPED_TEST(EveryMethod, DeliversEveryMessageOnceBelowSaturation) {
  Random random(3);
  const Medium medium = gigabit(8);
  const auto load = random_load(medium, kRandomLoad, Time{}, 4ms, random);
  const auto messages = with_interrupts(load, medium, 50, 80us, random);
  const auto at = TypeParam().carry(medium, messages, core::kNever);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    EXPECT_NE(at[i], core::kNever);
    EXPECT_GT(at[i], messages[i].asked);
  }
}

TYPED_TEST(EveryMethod, KeepsTheOrderOfOneNodesMessagesToAnother) {
  std::vector<Message> messages;
  for (unsigned i = 0; i < 20; ++i) messages.push_back(data(i * 100ns, 5, 2, 512));
  const auto at = deliveries(TypeParam(), gigabit(8), messages);
  EXPECT_TRUE(std::is_sorted(at.begin(), at.end()));
}

TYPED_TEST(EveryMethod, CarriesMessagesOfAnySize) {
  for (const unsigned size : {1u, 55u, 57u, 253u, 255u, 509u, 512u})
    EXPECT_GT(delivery(TypeParam(), gigabit(8, size), data(0ns, 5, 2, size)), size * 8ns);
}

TYPED_TEST(EveryMethod, RunsWithTwoNodesAndWithMany) {
  for (const unsigned nodes : {2u, 100u}) deliveries(TypeParam(), gigabit(nodes), all_to(gigabit(nodes), 1));
}

ComparisonOptions small() {
  ComparisonOptions options;
  options.medium = gigabit(4);
  options.loads = {0.1};
  options.nodes = {2, 4};
  return options;
}

TEST(Comparison, HasEveryMethodAtBothRates) {
  const Comparison all = compare(small());
  ASSERT_EQ(all.methods.size(), 12u);
  EXPECT_EQ(all.against_load.size(), 12u);
  EXPECT_EQ(all.against_nodes.size(), 24u);
  EXPECT_EQ(all.methods[7].subject.method, "ARCNET");
  EXPECT_EQ(all.methods[7].subject.rate, 5'000'000u);
  EXPECT_FALSE(all.methods[1].subject.own_rate);
}

// protocol.md section 7.2, and the frames of CAN: 8 a message, 579 ns each but for the last one's intermission.
TEST(Comparison, MeasuresWhatTheModelsSay) {
  const Comparison all = compare(small());
  const Figures &ring = all.methods[0].figures, &can = all.methods[5].figures;
  const Duration T = 8ns * 524, d = 512ns;
  EXPECT_EQ(ring.alone.worst, T + 2 * d);
  EXPECT_EQ(ring.at_once_opposite.worst, 2 * T + d);
  // Random destinations: deliveries are not evenly spread over a lap.
  EXPECT_NEAR(ring.efficiency, 512.0 / 524 * 4 * T.count() / (4 * T + d).count(), 0.005);
  EXPECT_EQ(can.alone.worst, 8 * 579ns - 3ns);
  EXPECT_EQ(can.at_once_opposite.worst, 4 * 8 * 579ns - 3ns);
  EXPECT_NEAR(can.efficiency, 512.0 / 579, 0.001);
}

TEST(Comparison, DeliversWhatIsOfferedBelowSaturation) {
  for (const LoadPoint& point : compare(small()).against_load)
    EXPECT_NEAR(point.delivered, 0.1, 0.002) << point.subject.method;
}

TEST(Comparison, GivesTheSameFiguresForTheSameSeed) {
  const Comparison one = compare(small()), other = compare(small());
  for (std::size_t i = 0; i < one.methods.size(); ++i) {
    EXPECT_EQ(one.methods[i].figures.interrupt.mean, other.methods[i].figures.interrupt.mean);
    EXPECT_EQ(one.methods[i].figures.efficiency, other.methods[i].figures.efficiency);
  }
}

TEST(Comparison, RandomLoadBeyondWhatAMethodCarriesIsNotAskedFor) {
  ComparisonOptions options = small();
  options.medium.payload = 1;  // 13 bytes on our ring for one of payload
  EXPECT_FALSE(compare(options).methods[0].figures.random_load.has_value());
}

TEST(Comparison, RefusesRelayDelaysFarBeyondAPacketAtAnyRateThatIsCompared) {
  Medium medium = gigabit(4);
  EXPECT_TRUE(comparable(medium));
  medium.relay_delay = 10ms;
  EXPECT_FALSE(comparable(medium));
  medium.rate = 1'000'000;  // a packet takes 4 ms, but 4 us at the ring's own rate
  EXPECT_FALSE(comparable(medium));
}

TEST(Comparison, RefusesMoreSmallMessagesThanFitIntoMemory) {
  EXPECT_TRUE(comparable(gigabit(16, 1)));
  EXPECT_FALSE(comparable(gigabit(254, 1)));
}

}  // namespace
}  // namespace limb_ring::study
