// Packets that nobody else would take off the ring, and the limits of the queues for the line.
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using wire::SliceKind;

struct Orphan : testing::Test {
  SoloNode solo;
  void SetUp() override { solo.join(); }
};

TEST_F(Orphan, ForeignPacketWithTheHopOfALapIsDiscardedNotReceived) {
  solo.receive(SliceKind::whole, Foreign{3, 1}.with_hop(3).with(pattern(8)));
  EXPECT_THAT(solo.line(), IsEmpty());
  EXPECT_THAT(solo.packets(), IsEmpty());
  EXPECT_EQ(solo.counters().orphans_hop, 1u);
}

TEST_F(Orphan, OneRelayLessIsNoOrphan) {
  solo.receive(SliceKind::whole, Foreign{2, 1}.with_hop(2).with(pattern(8)));
  EXPECT_THAT(solo.line(), SizeIs(1));
  EXPECT_THAT(solo.packets(), SizeIs(1));
}

TEST_F(Orphan, InterruptsAreJudgedAlike) {
  Bytes interrupt = foreign_interrupt(3, 1, 1);
  wire::rewrite(interrupt.data(), interrupt.size(), 3, wire::kFbcUntaken);
  solo.receive(SliceKind::interrupt, interrupt);
  EXPECT_THAT(solo.line(), IsEmpty());
  EXPECT_EQ(solo.counters().pins_pulled, 0u);
  EXPECT_EQ(solo.counters().orphans_hop, 1u);
}

TEST_F(Orphan, PacketOfABypassedNodeIsReceivedThenDiscarded) {
  solo.node().output_up(3_id, solo.now());  // past node 2
  solo.receive(SliceKind::whole, Foreign{2, 1}.with(pattern(8)));
  solo.receive(SliceKind::interrupt, foreign_interrupt(2, 1, 1));
  EXPECT_THAT(solo.packets(), ElementsAre(pattern(8)));
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
  EXPECT_EQ(solo.counters().orphans_bypassed, 2u);
  EXPECT_THAT(solo.line(), IsEmpty());
}

TEST_F(Orphan, NodeThatIsBackIsBypassedNoLonger) {
  solo.node().output_up(3_id, solo.now());
  solo.node().output_up(2_id, solo.now());
  solo.receive(SliceKind::whole, Foreign{2, 3}.with(pattern(8)));
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::whole));
}

TEST(Orphans, OfADeadSourceAreGoneAfterALap) {
  VirtualRing ring(quick(8));
  ASSERT_TRUE(ring.join());
  ring.send(3_id, wire::kBroadcast, text("last words"));
  ring.run_for(2us);
  ring.kill(3_id);
  ring.run_for(1ms);
  std::uint64_t slices = 0;
  ring.tap(0_id, [&](const wire::Slice&, Time, wire::SliceWriter&) { ++slices; });
  ring.run_for(10s);
  EXPECT_EQ(slices, 0u);
  for (NodeId id : {4_id, 5_id, 6_id, 7_id, 0_id, 1_id, 2_id})
    EXPECT_THAT(payloads(ring.log(id)), ElementsAre(text("last words"))) << int{id};
}

// Nothing goes out, more comes in than there is room for.
struct InsertionBufferFull : testing::Test {
  SoloNode solo{Duration{0}, [](Settings& s) {
                  s.insertion_buffer = 2;
                  s.interrupt_buffer = 3;
                }};
  void SetUp() override {
    solo.join();
    solo.node().set_output_ready(false);
  }
};

TEST_F(InsertionBufferFull, PacketIsDroppedWholeAndNotReceived) {
  for (std::uint8_t i = 0; i < 4; ++i)
    solo.receive(SliceKind::whole, Foreign{0, 1}.with_sequence(i).with(Bytes(512, i)));
  EXPECT_THAT(solo.packets(), ElementsAre(Bytes(512, 0), Bytes(512, 1)));
  EXPECT_EQ(solo.counters().insertion_buffer_full, 2u);
  EXPECT_EQ(solo.counters().relayed_data, 2u);
  EXPECT_EQ(solo.node().insertion_buffer().count(), 2u);
  solo.node().set_output_ready(true);
  solo.run();
  EXPECT_THAT(solo.line(), SizeIs(2));
}

TEST_F(InsertionBufferFull, PacketInPiecesIsDroppedWholeToo) {
  for (std::uint8_t i = 0; i < 2; ++i)
    solo.receive(SliceKind::whole, Foreign{0, 2}.with_sequence(i).with(pattern(512)));
  const Bytes third = Foreign{0, 1}.with_sequence(2).with(pattern(512));
  solo.receive(SliceKind::start, head_of(third));
  solo.node().set_output_ready(true);
  solo.run();
  solo.receive(SliceKind::end, tail_of(third));
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::whole, SliceKind::whole));
  EXPECT_THAT(solo.packets(), IsEmpty());
  EXPECT_EQ(solo.counters().stray_slices, 0u);
}

TEST_F(InsertionBufferFull, OwnPacketStillComesHome) {
  for (std::uint8_t i = 0; i < 2; ++i)
    solo.receive(SliceKind::whole, Foreign{0, 2}.with_sequence(i).with(pattern(512)));
  solo.receive(SliceKind::whole, Foreign{1, 2}.with(pattern(512)));
  EXPECT_EQ(solo.counters().returns_unmatched, 1u);
  EXPECT_EQ(solo.counters().insertion_buffer_full, 0u);
}

TEST_F(InsertionBufferFull, InterruptsHaveTheirOwnLimit) {
  for (std::uint8_t i = 0; i < 5; ++i) solo.receive(SliceKind::interrupt, foreign_interrupt(0, 2, 1, i));
  EXPECT_EQ(solo.counters().interrupt_buffer_full, 2u);
  EXPECT_EQ(solo.counters().relayed_interrupts, 3u);
}

TEST(InsertionBufferSize, IsAtLeastTwo) {
  SoloNode solo(Duration{0}, [](Settings& s) { s.insertion_buffer = 0; });
  solo.join();
  solo.node().set_output_ready(false);
  for (std::uint8_t i = 0; i < 3; ++i)
    solo.receive(SliceKind::whole, Foreign{0, 2}.with_sequence(i).with(pattern(512)));
  EXPECT_EQ(solo.counters().insertion_buffer_full, 1u);
}

// While a node sends the largest DATP, a small one of every other node may come in.
TEST(InsertionBufferSize, HoldsAsManySmallPacketsAsItHasBytes) {
  VirtualRing ring{gigabit(64)};
  ASSERT_TRUE(ring.join());
  std::vector<std::uint32_t> tokens{ring.send(0_id, 1_id, Bytes(512))};
  for (NodeId id{1}; id < 64; ++id) tokens.push_back(ring.send(id, 0_id, Bytes(1)));
  for (NodeId id{0}; id < 64; ++id) EXPECT_EQ(outcome_of(ring, id, tokens[id]).tries, 1u);
  for (NodeId id{0}; id < 64; ++id) EXPECT_EQ(ring.counters(id).insertion_buffer_full, 0u);
}

TEST(LostOutput, WhatWaitedIsDroppedAndCountedNotReplayed) {
  SoloNode solo;
  solo.join();
  solo.node().set_output_ready(false);
  solo.receive(SliceKind::whole, Foreign{0, 2}.with(pattern(8)));
  solo.receive(SliceKind::interrupt, foreign_interrupt(0, 2, 1));
  solo.node().output_lost(solo.now());
  solo.receive(SliceKind::whole, Foreign{0, 2}.with_sequence(1).with(pattern(8)));
  EXPECT_EQ(solo.counters().dropped_no_output, 3u);
  solo.node().output_up(2_id, solo.now());
  solo.run();
  EXPECT_THAT(solo.line(), IsEmpty());
}

TEST(LostOutput, WhatComesInPiecesIsCountedOnce) {
  SoloNode solo;
  solo.join();
  solo.node().output_lost(solo.now());
  const Bytes packet = Foreign{0, 2}.with(pattern(8));
  solo.receive(SliceKind::start, head_of(packet));
  solo.receive(SliceKind::end, tail_of(packet));
  EXPECT_EQ(solo.counters().dropped_no_output, 1u);
}

TEST(LostOutput, PacketStillComingInIsNotContinuedOnTheNewOne) {
  SoloNode solo;
  solo.join();
  const Bytes packet = Foreign{0, 2}.with(pattern(8));
  solo.receive(SliceKind::start, head_of(packet));
  solo.node().output_up(3_id, solo.now());
  solo.line();
  solo.receive(SliceKind::end, tail_of(packet));
  EXPECT_THAT(solo.line(), IsEmpty());
}

}  // namespace
}  // namespace limb_ring::core
