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

// CAN FD at 1 Gbit/s, a bit in 1 ns. A frame with 64 bytes: head 1+11+6+4 = 22, data 512, stuff count
// 4 + CRC 21 + 7 fixed stuff bits = 32, tail 3+7 = 10: 576 bits, and 3 of intermission.

namespace {

TEST(Can, FramesAreAsLongAsTheStandardSays) {
  EXPECT_EQ(CanBus::frame_bits(64), 576u);
  EXPECT_EQ(CanBus::frame_bits(0), 22u + 4 + 17 + 6 + 10);
  EXPECT_EQ(CanBus::frame_bits(16), 22u + 128 + 4 + 17 + 6 + 10);
  EXPECT_EQ(CanBus::frame_bits(20), 22u + 160 + 4 + 21 + 7 + 10);
}

TEST(Can, DataIsPaddedToTheNextSizeThereIs) {
  EXPECT_EQ(CanBus::frame_bits(9), CanBus::frame_bits(12));
  EXPECT_EQ(CanBus::frame_bits(33), CanBus::frame_bits(48));
}

TEST(Can, LongMessageGoesAsSeveralFrames) {
  EXPECT_EQ(delivery(CanBus(), gigabit(4), data(0ns, 1, 2, 512)), 7 * 579ns + 576ns);
}

TEST(Can, MessageThatArrivesWhileTheBusIsFreeStartsAtOnce) {
  EXPECT_EQ(delivery(CanBus(), gigabit(4), data(700ns, 1, 2, 64)), 700ns + 576ns);
}

TEST(Can, AllAtOnceGoInTheOrderOfTheirIdentifiers) {
  const Duration each = 8 * 579ns;
  EXPECT_THAT(deliveries(CanBus(), gigabit(4), all_to(gigabit(4), 2)),
              ElementsAre(each - 3ns, 2 * each - 3ns, 3 * each - 3ns, 4 * each - 3ns));
}

TEST(Can, HigherPriorityGoesBeforeLowerNodeNumber) {
  EXPECT_THAT(deliveries(CanBus(), gigabit(4), {data(0ns, 0, 1, 64, 3), data(0ns, 3, 1, 64, 0)}),
              ElementsAre(579ns + 576ns, 576ns));
}

TEST(Can, BetterIdentifierWinsBetweenTheFramesOfALongMessage) {
  EXPECT_THAT(deliveries(CanBus(), gigabit(4), {data(0ns, 2, 0, 128), data(1ns, 1, 0, 64)}),
              ElementsAre(2 * 579ns + 576ns, 579ns + 576ns));
}

// It came 100 ns into a frame: that frame's end and intermission, then 59 bits of its own.
TEST(Can, InterruptWaitsForTheFrameOnTheBusAndForNothingElse) {
  auto messages = all_to(gigabit(4), 1);
  messages.push_back(interrupt(100ns, 3, 0));
  EXPECT_EQ(deliveries(CanBus(), gigabit(4), messages).back(), 579ns + 59ns);
}

TEST(Can, MessageThatComesTooLateIsNotDelivered) {
  EXPECT_THAT(CanBus().carry(gigabit(4), {data(0ns, 0, 1, 64), data(0ns, 1, 0, 64)}, Time{} + 576ns),
              ElementsAre(Time{} + 576ns, core::kNever));
}

// 11 bits in vain at the end of one frame, then the whole next one.
TEST(Can, NewNodeWaitsForTheEndOfAFrame) { EXPECT_EQ(CanBus().time_to_join(gigabit(4)), 11ns + 579ns); }

}  // namespace

}  // namespace limb_ring::study
