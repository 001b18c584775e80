// What all methods have in common, and what the comparison makes of them.

#include "comparison/comparison.h"
#include "comparison/buses.h"
#include "comparison/network.h"
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

TEST(Comparison, RandomLoadAboveTheCapacityOfAMethodIsLeftOut) {
  ComparisonOptions options = small();
  options.medium.payload = 1;  // 13 bytes on our ring for one of payload
  EXPECT_FALSE(compare(options).methods[0].figures.random_load.has_value());
}

TEST(Comparison, RefusesRelayDelaysMuchLongerThanAPacketAtAnyComparedRate) {
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

const Medium kLoaded = gigabit(16);

bool in_order(const std::vector<Message>& messages) {
  return std::is_sorted(messages.begin(), messages.end(),
                        [](const Message& a, const Message& b) { return a.asked < b.asked; });
}

TEST(OfferedLoad, SameSeedGivesTheSameMessages) {
  Random one(7), other(7);
  const auto a = random_load(kLoaded, 0.5, Time{}, 1ms, one), b = random_load(kLoaded, 0.5, Time{}, 1ms, other);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].asked, b[i].asked);
    EXPECT_EQ(a[i].source, b[i].source);
    EXPECT_EQ(a[i].destination, b[i].destination);
  }
}

// Half of 1 Gbit/s for 4.096 ms is 2.048 Mbit: 500 messages of 4096 bit.
TEST(OfferedLoad, RandomLoadOffersItsShareOfTheRate) {
  Random random(1);
  const auto messages = random_load(kLoaded, 0.5, Time{}, 4096us, random);
  EXPECT_EQ(messages.size(), 500u);
  EXPECT_TRUE(in_order(messages));
}

TEST(OfferedLoad, NobodySendsToItself) {
  Random random(1);
  for (const Message& m : random_load(gigabit(3), 1.0, Time{}, 10ms, random)) EXPECT_NE(m.source, m.destination);
}

TEST(OfferedLoad, AllAtOnceIsOneMessagePerNodeAndTurn) {
  Random random(1);
  const auto messages = all_at_once(kLoaded, Time{} + 3us, 2, Destination::opposite, random);
  ASSERT_EQ(messages.size(), 32u);
  for (unsigned i = 0; i < 32; ++i) {
    EXPECT_EQ(messages[i].asked, Time{} + 3us);
    EXPECT_EQ(messages[i].source, i % 16);
    EXPECT_EQ(messages[i].destination, (i + 8) % 16);
  }
}

TEST(OfferedLoad, InterruptsComeInTheFirstHalfOfTheirGaps) {
  Random random(1);
  const auto messages = with_interrupts({}, kLoaded, 100, 10us, random);
  ASSERT_EQ(messages.size(), 100u);
  for (unsigned i = 0; i < 100; ++i) {
    EXPECT_TRUE(messages[i].interrupt);
    EXPECT_GE(messages[i].asked, Time{} + i * 10us);
    EXPECT_LT(messages[i].asked, Time{} + i * 10us + 5us);
  }
}

}  // namespace

}  // namespace limb_ring::study
