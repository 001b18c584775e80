// CAN FD at 1 Gbit/s, a bit in 1 ns. A frame with 64 bytes: head 1+11+6+4 = 22, data 512, stuff count
// 4 + CRC 21 + 7 fixed stuff bits = 32, tail 3+7 = 10: 576 bits, and 3 of intermission.
#include "comparison/buses.h"
#include "comparison/test/network_fixture.h"

namespace limb_ring::study {
namespace {

using testing::ElementsAre;

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

TEST(Can, MessageThatComesAsTheBusIsFreeStartsAtOnce) {
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

TEST(Can, WhatComesTooLateIsNotDelivered) {
  EXPECT_THAT(CanBus().carry(gigabit(4), {data(0ns, 0, 1, 64), data(0ns, 1, 0, 64)}, Time{} + 576ns),
              ElementsAre(Time{} + 576ns, core::kNever));
}

// 11 bits in vain at the end of one frame, then the whole next one.
TEST(Can, NewNodeWaitsForTheEndOfAFrame) { EXPECT_EQ(CanBus().time_to_join(gigabit(4)), 11ns + 579ns); }

}  // namespace
}  // namespace limb_ring::study
