#include "comparison/network.h"
#include "comparison/test/network_fixture.h"

namespace limb_ring::study {
namespace {

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
