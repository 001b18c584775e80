// ARCNET at 1 Gbit/s, a bit in 1 ns, a turnaround in 31.5 ns. Token and enquiry: 6 + 3*11 = 39 bits;
// ACK: 6 + 11 = 17. A packet with 100 bytes: 6 + 11*(5 + 100 + 2) = 1183.
#include "comparison/buses.h"
#include "comparison/test/network_fixture.h"

namespace limb_ring::study {
namespace {

using testing::ElementsAre;

constexpr Duration kTurnaround{31500};
constexpr Duration kPass = 39ns + kTurnaround;                                        // of the token
constexpr Duration kAsk = 39ns + kTurnaround + 17ns + kTurnaround;                    // enquiry and answer
constexpr Duration kTurn = kAsk + 1183ns + kTurnaround + 17ns + kTurnaround + kPass;  // with 100 bytes

TEST(Arcnet, PacketsAreAsLongAsTheStandardSays) {
  EXPECT_EQ(Arcnet::packet_bits(100), 1183u);
  EXPECT_EQ(Arcnet::packet_bits(253), 6u + 11 * (5 + 253 + 2));
  EXPECT_EQ(Arcnet::packet_bits(257), 6u + 11 * (6 + 257 + 2));
}

TEST(Arcnet, LengthsBetweenShortAndLongPacketsArePadded) {
  EXPECT_EQ(Arcnet::packet_bits(254), Arcnet::packet_bits(257));
}

TEST(Arcnet, NodeWithTheTokenAsksThenSends) {
  EXPECT_EQ(delivery(Arcnet(), gigabit(4), data(0ns, 0, 2, 100)), kAsk + 1183ns);
}

TEST(Arcnet, NodeWithoutTheTokenWaitsForIt) {
  EXPECT_EQ(delivery(Arcnet(), gigabit(4), data(0ns, 2, 0, 100)), 2 * kPass + kAsk + 1183ns);
}

// Asked for just after the token came: once round, three others pass it on, too.
TEST(Arcnet, TheTokenVisitsEveryNode) {
  EXPECT_EQ(delivery(Arcnet(), gigabit(4), data(1ns, 0, 2, 100)), 4 * kPass + kAsk + 1183ns);
}

// 508 bytes: 6 + 11*(6 + 508 + 2) = 5682 bits; then 4 bytes at the next visit: 6 + 11*(5 + 4 + 2) = 127.
TEST(Arcnet, LongMessageTakesTwoVisitsOfTheToken) {
  const Duration first = kAsk + 5682ns + kTurnaround + 17ns + kTurnaround + kPass;
  EXPECT_EQ(delivery(Arcnet(), gigabit(4), data(0ns, 0, 2, 512)), first + 3 * kPass + kAsk + 127ns);
}

TEST(Arcnet, AllAtOnceGoInTheOrderOfTheToken) {
  const Duration one = kAsk + 1183ns;
  EXPECT_THAT(deliveries(Arcnet(), gigabit(4, 100), all_to(gigabit(4, 100), 2)),
              ElementsAre(one, kTurn + one, 2 * kTurn + one, 3 * kTurn + one));
}

// One byte: 6 + 11*(5 + 1 + 2) = 94 bits, at the next visit: the second packet of its node waits.
TEST(Arcnet, InterruptGoesBeforeItsOwnNodesDataButNeedsTheToken) {
  const auto at = deliveries(Arcnet(), gigabit(4), {data(0ns, 0, 2, 100), data(0ns, 0, 2, 100), interrupt(10ns, 0, 2)});
  EXPECT_EQ(at[2], kTurn + 3 * kPass + kAsk + 94ns);
  EXPECT_GT(at[1], at[2]);
}

TEST(Arcnet, PriorityCountsWithinANodeOnly) {
  const auto at =
      deliveries(Arcnet(), gigabit(4), {data(0ns, 0, 2, 100, 3), data(0ns, 0, 2, 100, 1), data(0ns, 1, 2, 100, 0)});
  EXPECT_LT(at[1], at[2]);
  EXPECT_LT(at[2], at[0]);
}

// Burst 765*9 bits, silence 205, then two nodes with a packet each.
TEST(Arcnet, NewNodeDestroysTheTokenAndWaitsItsTurn) {
  EXPECT_EQ(Arcnet().time_to_join(gigabit(2, 100)), 6885ns + 205ns + 2 * kTurn);
}

}  // namespace
}  // namespace limb_ring::study
