// Responsive Link at 1 Gbit/s: a data packet of 64 bytes in 512 ns, an event packet in 128 ns. 512 bytes of
// data are 10 packets of at most 56.
#include "comparison/point_to_point.h"
#include "comparison/test/network_fixture.h"

namespace limb_ring::study {
namespace {

using testing::ElementsAre;

constexpr Duration kPacket = 512ns, kEvent = 128ns;

TEST(ResponsiveLink, PacketsFollowEachOtherAndCutThrough) {
  EXPECT_EQ(delivery(ResponsiveLink(), gigabit(8), data(0ns, 0, 2, 512)), 10 * kPacket + 2 * d);
}

TEST(ResponsiveLink, ShorterWayIsTaken) {
  EXPECT_EQ(delivery(ResponsiveLink(), gigabit(8), data(0ns, 0, 7, 56)), kPacket + d);
  EXPECT_EQ(delivery(ResponsiveLink(), gigabit(8), data(0ns, 0, 5, 56)), kPacket + 3 * d);
}

// Two hops of five: all one way round. Each line first has its own node's ten, then the neighbour's.
TEST(ResponsiveLink, AllAtOnceQueueBehindEachNodesOwn) {
  EXPECT_THAT(deliveries(ResponsiveLink(), gigabit(5), all_to(gigabit(5), 2)),
              testing::Each(Duration(2 * 10 * kPacket + d)));
}

// Half-way round: the even nodes one way, the odd ones the other, so no line has more than one's own or
// relayed ten.
TEST(ResponsiveLink, HalfWayRoundBothDirectionsAreUsed) {
  EXPECT_THAT(deliveries(ResponsiveLink(), gigabit(4), all_to(gigabit(4), 2)),
              testing::Each(Duration(10 * kPacket + 2 * d)));
}

TEST(ResponsiveLink, HigherPriorityOvertakesBetweenPackets) {
  EXPECT_THAT(deliveries(ResponsiveLink(), gigabit(8), {data(0ns, 0, 1, 512, 3), data(100ns, 0, 1, 56, 0)}),
              ElementsAre(11 * kPacket + d, 2 * kPacket + d));
}

// It reaches node 1 as that node's first packet ends.
TEST(ResponsiveLink, HigherPriorityOvertakesAtTheNextNodeToo) {
  EXPECT_THAT(deliveries(ResponsiveLink(), gigabit(8), {data(0ns, 0, 2, 56, 0), data(0ns, 1, 2, 512, 3)}),
              ElementsAre(d + kPacket + d, 11 * kPacket + d));
}

TEST(ResponsiveLink, EqualPriorityGoesInTheOrderInWhichItCame) {
  EXPECT_THAT(deliveries(ResponsiveLink(), gigabit(8), {data(0ns, 0, 2, 56), data(0ns, 1, 2, 512)}),
              ElementsAre(10 * kPacket + kPacket + d, 10 * kPacket + d));
}

TEST(ResponsiveLink, EventsHaveLinesOfTheirOwn) {
  auto messages = all_to(gigabit(8), 2);
  messages.push_back(interrupt(0ns, 0, 2));
  EXPECT_EQ(deliveries(ResponsiveLink(), gigabit(8), messages).back(), kEvent + 2 * d);
}

TEST(ResponsiveLink, NewNodeSendsAtOnce) { EXPECT_EQ(ResponsiveLink().time_to_join(gigabit(8)), 0ns); }

}  // namespace
}  // namespace limb_ring::study
