// A packet that cannot be finished is aborted, bytes that are not a packet are discarded, and both are counted.
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using wire::SliceKind;

struct BrokenPacket : testing::Test {
  SoloNode solo;
  const Bytes packet = Foreign{0, 1}.with(pattern(22));
  void SetUp() override { solo.join(); }
};

TEST_F(BrokenPacket, WholeInPiecesPassesAndIsTaken) {
  solo.receive(SliceKind::start, {packet.begin(), packet.begin() + 8});
  solo.receive(SliceKind::more, {packet.begin() + 8, packet.begin() + 20});
  solo.receive(SliceKind::end, {packet.begin() + 20, packet.end()});
  Bytes passed;
  const auto out = solo.line();
  for (const auto& slice : out) passed.insert(passed.end(), slice.bytes.begin(), slice.bytes.end());
  EXPECT_EQ(out.front().kind, SliceKind::start) << "cut-through: passed on before its end was in";
  EXPECT_EQ(passed, SoloNode::home(packet, 32, 1));
  EXPECT_EQ(solo.counters().relayed_data, 1u);
  EXPECT_THAT(solo.packets(), ElementsAre(pattern(22)));
}

TEST_F(BrokenPacket, AbortIsPassedOnAndNothingIsTaken) {
  solo.receive(SliceKind::start, head_of(packet));
  solo.receive(SliceKind::abort, {});
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start, SliceKind::abort));
  EXPECT_THAT(solo.packets(), IsEmpty());
  EXPECT_EQ(solo.counters().aborts_received, 1u);
}

TEST_F(BrokenPacket, WhatWaitsBehindAnAbortGoesInTheSameTurn) {
  solo.receive(SliceKind::start, head_of(packet));
  solo.line();
  solo.node().set_output_ready(false);
  solo.receive(SliceKind::abort, {});
  solo.receive(SliceKind::whole, packet);
  solo.node().set_output_ready(true);
  solo.run();
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::abort, SliceKind::whole));
}

// Once it kept its room until its turn came, and others were discarded for want of it.
TEST_F(BrokenPacket, AnAbortOfWhatHasNotBegunToLeaveMakesRoomAtOnce) {
  solo.node().set_output_ready(false);
  solo.receive(SliceKind::whole, packet);
  solo.receive(SliceKind::start, head_of(packet));
  solo.receive(SliceKind::abort, {});
  EXPECT_EQ(solo.node().insertion_buffer().count(), 1u);
  EXPECT_EQ(solo.node().insertion_buffer().bytes(), packet.size());
  solo.node().set_output_ready(true);
  solo.run();
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::whole));
}

TEST_F(BrokenPacket, WhatWaitsBehindAnEndGoesInTheSameTurn) {
  solo.receive(SliceKind::start, head_of(packet));
  solo.line();
  solo.node().set_output_ready(false);
  solo.receive(SliceKind::end, tail_of(packet));
  solo.receive(SliceKind::whole, packet);
  solo.node().set_output_ready(true);
  solo.run();
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::end, SliceKind::whole));
}

TEST_F(BrokenPacket, IsBrokenOffByAGapOfItsOwnLine) {
  NetworkController node(solo.node().settings(), Time{});
  node.apply(input::InputUp{Line::first, 0_id}, Time{});
  node.apply(input::OutputUp{Line::first, 2_id}, Time{});
  node.receive(Line::first, {SliceKind::start, {packet.data(), wire::kHeaderSize}}, Time{});
  node.apply(input::InputGap{Line::second}, Time{});
  EXPECT_EQ(node.counters().broken_off_packets, 0u);
  node.apply(input::InputGap{Line::first}, Time{});
  EXPECT_EQ(node.counters().broken_off_packets, 1u);
}

TEST_F(BrokenPacket, ThatStallsIsAborted) {
  solo.receive(SliceKind::start, head_of(packet));
  solo.run_for(49ms);
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start));
  solo.run_for(1ms);
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::abort));
  EXPECT_EQ(solo.counters().stalled_packets, 1u);
  solo.receive(SliceKind::end, tail_of(packet));
  EXPECT_THAT(solo.line(), IsEmpty());
  EXPECT_EQ(solo.counters().stray_slices, 1u);
}

TEST_F(BrokenPacket, EverySliceRestartsTheStallTimer) {
  solo.receive(SliceKind::start, {packet.begin(), packet.begin() + 4});
  for (std::size_t at = 4; at < 24; at += 4) {
    solo.run_for(49ms);
    solo.receive(SliceKind::more, {packet.begin() + static_cast<long>(at), packet.begin() + static_cast<long>(at) + 4});
  }
  solo.run_for(49ms);
  solo.receive(SliceKind::end, {packet.begin() + 24, packet.end()});
  EXPECT_THAT(solo.packets(), ElementsAre(pattern(22)));
}

TEST_F(BrokenPacket, LongerThan524BytesIsAborted) {
  solo.receive(SliceKind::start, head_of(Foreign{0, 1}.with(pattern(512))));
  solo.receive(SliceKind::more, pattern(12));
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start, SliceKind::abort));
  EXPECT_EQ(solo.counters().oversize_packets, 1u);
}

TEST_F(BrokenPacket, WhoseEndMakesItTooLongIsAbortedAndNotLookedAt) {
  solo.receive(SliceKind::start, head_of(Foreign{0, 1}.with(pattern(512))));
  solo.receive(SliceKind::end, Bytes(12));
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start, SliceKind::abort));
  EXPECT_THAT(solo.packets(), IsEmpty());
  EXPECT_EQ(solo.counters().oversize_packets, 1u);
  EXPECT_EQ(solo.counters().crc_errors, 0u);
}

// A defective node upstream: 524 bytes without an end. What of it waited for the output would have gone on as a `start`
// of 524 bytes, which is none, and the innocent node would have been hung up on.
TEST_F(BrokenPacket, MoreWordsThanAPayloadHasAreAbortedThoughTheyWouldFit) {
  solo.node().set_output_ready(false);
  solo.receive(SliceKind::start, head_of(packet));
  solo.receive(SliceKind::more, pattern(512));
  solo.node().set_output_ready(true);
  solo.run();
  EXPECT_EQ(solo.counters().oversize_packets, 1u);
  for (const auto& slice : solo.line()) EXPECT_TRUE(wire::slice_size_fits(slice.kind, slice.bytes.size()));
}

TEST_F(BrokenPacket, WhatWaitedForTheOutputGoesOnInLegalSlices) {
  const Bytes longest = Foreign{0, 1}.with(pattern(512));
  solo.node().set_output_ready(false);
  solo.receive(SliceKind::start, {longest.begin(), longest.begin() + 4});
  solo.receive(SliceKind::more, {longest.begin() + 4, longest.begin() + 516});
  solo.node().set_output_ready(true);
  solo.run();
  solo.receive(SliceKind::end, {longest.begin() + 516, longest.end()});
  const auto out = solo.line();
  EXPECT_EQ(out.size(), 2u);
  for (const auto& slice : out) EXPECT_TRUE(wire::slice_size_fits(slice.kind, slice.bytes.size()));
  EXPECT_THAT(solo.packets(), ElementsAre(pattern(512)));
}

TEST_F(BrokenPacket, ShorterThan13BytesIsAborted) {
  solo.receive(SliceKind::start, {packet.begin(), packet.begin() + 4});
  solo.receive(SliceKind::end, Bytes(8));
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start, SliceKind::abort));
  EXPECT_EQ(solo.counters().malformed_packets, 1u);
}

TEST_F(BrokenPacket, AnotherBeginningInsideItBreaksItOff) {
  solo.receive(SliceKind::start, head_of(packet));
  solo.receive(SliceKind::whole, packet);
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start, SliceKind::abort, SliceKind::whole));
  EXPECT_EQ(solo.counters().broken_off_packets, 1u);
  EXPECT_THAT(solo.packets(), ElementsAre(pattern(22)));
}

// A batch of what comes in at one instant goes on slice by slice, whatever becomes of the next one.
TEST_F(BrokenPacket, IsBrokenOffAtOnceByOneThatGoesNoFurther) {
  Bytes malformed = packet;
  malformed[wire::field::kSop] = 0;
  solo.give(SliceKind::start, head_of(packet));
  solo.give(SliceKind::whole, malformed);
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start, SliceKind::abort));

  solo.node().output_up(3_id, solo.now());  // node 2 is bypassed
  const Bytes bypassed = Foreign{2, 1}.with(pattern(8));
  solo.give(SliceKind::start, head_of(packet));
  solo.give(SliceKind::whole, bypassed);
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start, SliceKind::abort));
}

TEST_F(BrokenPacket, LostInputBreaksItOff) {
  solo.receive(SliceKind::start, head_of(packet));
  solo.node().input_lost(solo.now());
  solo.run();
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start, SliceKind::abort));
}

TEST_F(BrokenPacket, ReplacedInputBreaksItOff) {
  solo.receive(SliceKind::start, head_of(packet));
  solo.node().input_up(3_id, solo.now());
  solo.run();
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start, SliceKind::abort));
}

TEST_F(BrokenPacket, GapBreaksItOff) {
  solo.receive(SliceKind::start, head_of(packet));
  solo.node().input_gap(solo.now());
  solo.run();
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start, SliceKind::abort));
  EXPECT_EQ(solo.counters().broken_off_packets, 1u);
}

TEST_F(BrokenPacket, InterruptInsideItGoesOn) {
  solo.receive(SliceKind::start, head_of(packet));
  solo.receive(SliceKind::interrupt, foreign_interrupt(0, 2, 1));
  solo.receive(SliceKind::abort, {});
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start, SliceKind::interrupt, SliceKind::abort));
}

TEST_F(BrokenPacket, InterruptInsideAStrippedOneGoesOn) {
  const Bytes own = Foreign{1, 2}.with(pattern(20));
  solo.receive(SliceKind::start, head_of(own));
  solo.receive(SliceKind::interrupt, foreign_interrupt(0, 2, 1));
  solo.receive(SliceKind::end, tail_of(own));
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::interrupt));
}

TEST_F(BrokenPacket, StraySlicesAreCounted) {
  solo.receive(SliceKind::more, Bytes(4));
  solo.receive(SliceKind::end, Bytes(8));
  solo.receive(SliceKind::abort, {});
  EXPECT_EQ(solo.counters().stray_slices, 3u);
  EXPECT_THAT(solo.line(), IsEmpty());
}

TEST_F(BrokenPacket, WithoutAValidHeaderIsDiscarded) {
  for (std::size_t at : {0u, 1u}) {  // Code's kind, SOP
    Bytes wrong = packet;
    wrong[at] ^= 0x20;
    solo.receive(SliceKind::whole, wrong);
    solo.receive(SliceKind::start, head_of(wrong));
    solo.receive(SliceKind::end, tail_of(wrong));
  }
  Bytes broadcast_source = packet;
  broadcast_source[3] = wire::kBroadcast;
  solo.receive(SliceKind::whole, broadcast_source);
  solo.receive(SliceKind::interrupt, {packet.begin(), packet.begin() + 12});
  EXPECT_THAT(solo.line(), IsEmpty());
  EXPECT_EQ(solo.counters().malformed_packets, 6u);
}

TEST_F(BrokenPacket, WithAGoodCrcButNoEopIsNotTaken) {
  Bytes wrong = packet;
  wrong[wrong.size() - 8] = 0;
  wire::store_u32(wrong.data() + wrong.size() - 4, wire::crc32({wrong.data(), wrong.size() - 4}));
  solo.receive(SliceKind::whole, wrong);
  EXPECT_THAT(solo.packets(), IsEmpty());
  EXPECT_EQ(solo.counters().malformed_packets, 1u);
}

TEST_F(BrokenPacket, WithABadCrcIsPassedOnStillBadAndNotTaken) {
  for (std::size_t at = 4; at < packet.size(); ++at) {
    Bytes wrong = packet;
    wrong[at] ^= 0x20;
    solo.receive(SliceKind::whole, wrong);
    const auto out = solo.line();
    ASSERT_EQ(out.size(), 1u) << at;
    EXPECT_FALSE((wire::PacketFields{{out[0].bytes.data(), out[0].bytes.size()}}.crc_good())) << at;
  }
  EXPECT_THAT(solo.packets(), IsEmpty());
  EXPECT_EQ(solo.counters().crc_errors, packet.size() - 4);
}

TEST_F(BrokenPacket, InterruptWithABadCrcPullsNoPinAndStaysBad) {
  Bytes wrong = foreign_interrupt(0, 1, 1);
  wrong[7] ^= 1;
  solo.receive(SliceKind::interrupt, wrong);
  EXPECT_EQ(solo.counters().pins_pulled, 0u);
  const auto out = solo.line();
  ASSERT_EQ(out.size(), 1u);
  EXPECT_FALSE((wire::PacketFields{{out[0].bytes.data(), out[0].bytes.size()}}.crc_good()));
}

TEST_F(BrokenPacket, WhatNobodyHasWrittenYetIsGoneWithItsLine) {
  solo.node().receive(Line::first, {SliceKind::whole, {packet.data(), packet.size()}}, solo.now());
  ASSERT_TRUE(solo.node().has_given_out());
  solo.node().output_replaced(solo.now());
  EXPECT_FALSE(solo.node().has_given_out());
}

TEST_F(BrokenPacket, IdleIsNothing) {
  solo.receive(SliceKind::start, head_of(packet));
  solo.receive(SliceKind::idle, {});
  solo.receive(SliceKind::end, tail_of(packet));
  EXPECT_THAT(solo.packets(), ElementsAre(pattern(22)));
}

}  // namespace
}  // namespace limb_ring::core
