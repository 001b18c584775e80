// What a node of a ring that falls into parts takes once only, and what it does not leave open on a line. (protocol.md
// sections 4.10, 6.3 and 8.11)
#include "core/lone_fold.h"

namespace limb_ring::core {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Not;
using wire::FoldWordKind;
using wire::SliceKind;

struct RingInParts : LoneFold {
  std::vector<SliceKind> kinds(Line line) {
    std::vector<SliceKind> all;
    wire::each_slice(node.output(line).view(), [&all](const wire::Slice& slice) { all.push_back(slice.kind); });
    node.output(line).clear();
    return all;
  }
  void receive(Line line, SliceKind kind, const Bytes& bytes) {
    node.receive(line, {kind, {bytes.data(), bytes.size()}}, Time{});
    node.run(Time{});
  }
  void lose_first_line() {
    node.input_lost(Line::first, Time{});
    node.output_lost(Line::first, Time{});
    node.run(Time{});
  }
};

// Nobody was behind the break when it turned back: all the others have repeated what it sent. It starts over since.
TEST_F(RingInParts, WhatTheNodeHasSentBackItselfPullsNoPinWhenItComesRound) {
  hear(FoldWordKind::deaf, 5_id);
  receive_interrupt(Line::first, 0, 2);
  ASSERT_EQ(node.counters().pins_pulled, 1u);
  hear(FoldWordKind::hears, 5_id);
  hear(FoldWordKind::begin, 4_id);
  lose_first_line();
  const auto discarded = node.counters().fold_discarded;
  receive_interrupt(Line::second, 0, 3);
  EXPECT_EQ(node.counters().pins_pulled, 1u);
  EXPECT_EQ(node.counters().fold_discarded, discarded + 1);
}

TEST_F(RingInParts, WhatComesBehindTheWordOfAnotherFoldNodeIsTakenAgain) {
  hear(FoldWordKind::begin, 4_id);
  lose_first_line();
  hear(FoldWordKind::begin, 3_id);
  receive_interrupt(Line::second, 0, 2);
  EXPECT_EQ(node.counters().pins_pulled, 1u);
}

TEST_F(RingInParts, AFoldNodeIsForgottenWhereTheOwnWordComesRound) {
  hear(FoldWordKind::begin, 6_id);
  node.output(Line::second).clear();
  hear(FoldWordKind::begin, 4_id);
  ASSERT_THAT(kinds(Line::second), ElementsAre(SliceKind::fold)) << "that nothing follows";
  receive_interrupt(Line::second, 0, 5);
  EXPECT_THAT(kinds(Line::second), ElementsAre()) << "nothing is repeated";
}

TEST_F(RingInParts, AnOwnPacketThatHasPassedNoRelayIsNotRepeated) {
  hear(FoldWordKind::begin, 6_id);
  node.output(Line::second).clear();
  test::InterruptPacket packet;
  packet.source = 4_id;
  packet.destination = wire::kBroadcast;
  receive(Line::second, SliceKind::interrupt, encoded(packet));
  EXPECT_THAT(kinds(Line::second), ElementsAre()) << "this node has sent it back, and it has come all the way round";
  packet.hop = 1;
  receive(Line::second, SliceKind::interrupt, encoded(packet));
  EXPECT_THAT(kinds(Line::second), ElementsAre(SliceKind::interrupt)) << "it was sent back at node 5 or beyond";
}

TEST_F(RingInParts, WhatWasTakenShortlyBeforeTheNodeStartedOverPullsNoPinAgain) {
  receive_interrupt(Line::first, 0, 2);
  lose_first_line();
  node.input_up(Line::first, 3_id, Time{});
  node.output_up(Line::first, 5_id, Time{});
  receive_interrupt(Line::first, 0, 2);
  EXPECT_EQ(node.counters().pins_pulled, 1u);
  EXPECT_EQ(node.counters().doubtful_retries, 1u);
  receive_interrupt(Line::first, 1, 2);
  EXPECT_EQ(node.counters().pins_pulled, 2u);
}

// ---- protocol.md section 6.3 ------------------------------------------------------------------------

const Bytes kPacket = Foreign{1, 2}.with(pattern(8));

TEST_F(RingInParts, ADatpOnTheFirstLineIsAbortedThereWhenTheNodeTurnsBack) {
  receive(Line::first, SliceKind::start, head_of(kPacket));
  node.output(Line::first).clear();
  hear(FoldWordKind::deaf, 5_id);
  EXPECT_THAT(kinds(Line::first), Contains(SliceKind::abort));
}

TEST_F(RingInParts, ADatpThatIsSentBackIsAbortedWhenTheInputIsLost) {
  hear(FoldWordKind::deaf, 5_id);
  receive(Line::first, SliceKind::start, head_of(kPacket));
  node.output(Line::second).clear();
  node.input_lost(Line::first, Time{});
  EXPECT_THAT(kinds(Line::second), Contains(SliceKind::abort));
}

TEST_F(RingInParts, ADatpThatTheNodeStopsRepeatingIsAborted) {
  hear(FoldWordKind::begin, 6_id);
  receive(Line::second, SliceKind::start, head_of(kPacket));
  node.output(Line::second).clear();
  hear(FoldWordKind::deaf, 5_id);
  EXPECT_THAT(kinds(Line::second), ElementsAre(SliceKind::abort, SliceKind::fold));
}

TEST_F(RingInParts, TheEndOfADatpIsNotRepeatedOntoALinkThatItDidNotBeginOn) {
  hear(FoldWordKind::begin, 6_id);
  receive(Line::second, SliceKind::start, head_of(kPacket));
  node.output_lost(Line::second, Time{});
  node.output_up(Line::second, 3_id, Time{});
  receive(Line::second, SliceKind::end, tail_of(kPacket));
  EXPECT_THAT(kinds(Line::second), Not(Contains(SliceKind::end)));
}

// ---- a ring over several hosts ------------------------------------------------------------------

/// Node 1's hello has gone round without node 0, whose host was out of reach.
struct PartOfSeveralHosts : testing::Test {
  SoloNode solo{Duration{0}, [](Settings& s) { s.several_hosts = true; }};
  void SetUp() override { solo.join(); }
};

TEST_F(PartOfSeveralHosts, ARetryOfANodeThatWasOutOfReachIsNotTaken) {
  solo.receive(SliceKind::whole, Foreign{0, 1}.with_attempt(1).with(text("x")));
  EXPECT_THAT(solo.packets(), ElementsAre());
  EXPECT_EQ(solo.counters().retries_of_unheard_nodes, 1u);
}

TEST_F(PartOfSeveralHosts, NorWithinTheTimeOfFourTriesIfItHasBeenHeardSince) {
  Bytes hello(wire::kHelloSize);
  wire::encode(wire::Hello{50}, hello.data());
  solo.receive(SliceKind::whole, Foreign{0, wire::kBroadcast}.with_pri(kControlPri).with(hello));
  solo.receive(SliceKind::whole, Foreign{0, 1}.with_sequence(3).with_attempt(1).with(text("x")));
  EXPECT_THAT(solo.packets(), ElementsAre());
  EXPECT_EQ(solo.counters().retries_of_unaware_nodes, 1u);
}

}  // namespace
}  // namespace limb_ring::core
