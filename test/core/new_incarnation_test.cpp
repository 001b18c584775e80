// Exactly once while nodes restart, are bypassed, and run out of sequence numbers.
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using wire::SliceKind;

/// A source whose try was repeated, and whose receiver has begun a new incarnation in between.
struct NewIncarnationOfTheReceiver : testing::Test {
  SoloNode solo;
  Bytes sent() { return solo.line().at(0).bytes; }
  void hello_of_2(std::uint64_t boot, std::uint8_t sequence) {
    Bytes bytes(wire::kHelloSize);
    wire::encode(wire::Hello{boot}, bytes.data());
    const Foreign hello = Foreign{2, wire::kBroadcast}.with_sequence(sequence).with_hop(1).with_pri(kControlPri);
    solo.receive(SliceKind::whole, hello.with(bytes));
    solo.line();
  }
  void beacon_of_3() {
    hear_of_break(solo);
    solo.line();
  }
  void SetUp() override {
    solo.join();
    hello_of_2(7, 0);
    solo.node().send(send_of(1, 1, 2_id, text("x")), solo.now());
    solo.run_for(100ms);
    ASSERT_EQ(solo.line().size(), 2u) << "the first try, and the second as it is overdue";
  }
};

TEST_F(NewIncarnationOfTheReceiver, RepeatsNothingTheFormerMayHaveTaken) {
  hello_of_2(8, 0);
  solo.run_for(1s);
  EXPECT_THAT(solo.line(), IsEmpty());
  EXPECT_THAT(solo.ends(), ElementsAre(testing::Field(&SendEnded::outcome, Outcome::lost)));
}

TEST_F(NewIncarnationOfTheReceiver, DoesNotSendAgainWhatItRefusedWhileItJoined) {
  solo.node().send(send_of(1, 2, 3_id, text("y")), solo.now());
  solo.receive(SliceKind::whole, SoloNode::home(Foreign{1, 2}.with_attempt(1).with(text("x")), 0));
  EXPECT_EQ(solo.counters().refusals, 1u);
  hello_of_2(8, 0);
  ASSERT_EQ(solo.ends().size(), 1u);
  EXPECT_EQ(solo.ends()[0].outcome, Outcome::lost);
  solo.run_for(50ms);
  EXPECT_EQ(solo.counters().sent_data, 1u + 2u + 1u) << "hello, two tries, and the next in the queue";
}

// In an open chain it may not hear of the receiver's new incarnation.
TEST_F(NewIncarnationOfTheReceiver, DoesNotSendIntoAnOpenChainWhatWasRefusedAfterARetry) {
  solo.receive(SliceKind::whole, SoloNode::home(Foreign{1, 2}.with_attempt(1).with(text("x")), 0));
  EXPECT_EQ(solo.counters().refusals, 1u);
  beacon_of_3();
  ASSERT_EQ(solo.node().membership().state(), NodeState::open_chain);
  ASSERT_EQ(solo.ends().size(), 1u);
  EXPECT_EQ(solo.ends()[0].outcome, Outcome::unconfirmed);
  solo.run_for(50ms);
  EXPECT_EQ(solo.counters().sent_data, 1u + 2u) << "hello, and two tries";
}

TEST_F(NewIncarnationOfTheReceiver, DeliversWhatComesHomeTaken) {
  hello_of_2(8, 0);
  solo.receive(SliceKind::whole, SoloNode::home(Foreign{1, 2}.with_attempt(1).with(text("x")), 5));
  EXPECT_THAT(solo.ends(), ElementsAre(testing::Field(&SendEnded::outcome, Outcome::delivered)));
}

/// The same before a try was repeated.
struct NewIncarnationAtTheFirstTry : NewIncarnationOfTheReceiver {
  void SetUp() override {
    solo.join();
    hello_of_2(7, 0);
    solo.node().send(send_of(1, 1, 2_id, text("x")), solo.now());
    solo.run();
    ASSERT_EQ(solo.line().size(), 1u);
  }
};

TEST_F(NewIncarnationAtTheFirstTry, WhatItRefusedGoesAgainAsANewPacketThatIsRepeated) {
  hello_of_2(8, 0);
  solo.receive(SliceKind::whole, SoloNode::home(Foreign{1, 2}.with(text("x")), 0));
  EXPECT_EQ(solo.counters().refusals, 1u);
  solo.run_for(1ms);
  ASSERT_EQ(solo.line().size(), 1u);
  solo.run_for(100ms);
  EXPECT_EQ(solo.line().size(), 1u);
  EXPECT_THAT(solo.ends(), IsEmpty());
}

TEST_F(NewIncarnationAtTheFirstTry, WhatItRefusedGoesAgainIntoAnOpenChain) {
  solo.receive(SliceKind::whole, SoloNode::home(Foreign{1, 2}.with(text("x")), 0));
  beacon_of_3();
  EXPECT_THAT(solo.ends(), IsEmpty());
  solo.run_for(1ms);
  EXPECT_EQ(solo.line().size(), 1u);
  EXPECT_THAT(solo.ends(), ElementsAre(testing::Field(&SendEnded::outcome, Outcome::unconfirmed)));
}

/// A node that was bypassed joins again while the ring is open: nobody confirms its hello.
struct BypassedAndInAnOpenChain : testing::Test {
  SoloNode solo{Duration{0}, [](Settings& s) { s.beacon = 10ms; }};
  void pull(std::uint8_t attempt) {
    solo.receive(SliceKind::interrupt, foreign_interrupt(3, 1, 1, 0, attempt));
    solo.line();
  }
  std::uint64_t pulled() const { return solo.counters().pins_pulled; }
  void SetUp() override {
    solo.join();
    pull(0);
    ASSERT_EQ(pulled(), 1u);
    solo.be_bypassed();
    hear_of_break(solo);
    ASSERT_EQ(solo.node().membership().state(), NodeState::open_chain);
  }
};

// The source may not know yet that the node has started over.
TEST_F(BypassedAndInAnOpenChain, ARepeatedInterruptIsNotTakenUntilTheNodesOwnBeaconHasComeHome) {
  solo.run();
  const auto out = solo.line();
  ASSERT_FALSE(out.empty());
  pull(1);
  EXPECT_EQ(pulled(), 1u);
  solo.receive(SliceKind::whole, SoloNode::home(out.back().bytes, wire::kFbcMax));
  pull(2);
  EXPECT_EQ(pulled(), 2u) << "all know of its start, so this one is new";
}

/// A node whose input is another one since an own packet was last home: it starts over when it loses its output.
struct InputIsAnother : testing::Test {
  static SoloNode folding() {
    return SoloNode{Duration{0}, [](Settings& s) { s.fold_back = true; }};
  }
  void replace_input(SoloNode& solo) {
    solo.node().input_lost(solo.now());
    solo.node().input_up(0_id, solo.now());
  }
  void replace_output(SoloNode& solo) {
    solo.node().output_lost(solo.now());
    solo.node().output_up(2_id, solo.now());
    ASSERT_EQ(solo.node().membership().state(), NodeState::joining);
  }
  void pull(SoloNode& solo) { solo.receive(SliceKind::interrupt, foreign_interrupt(3, 1, 1)); }
};

// Its line has doubled an INTP; between the two copies the node starts over. (soak, seed 3820048588)
TEST_F(InputIsAnother, WhatCameOnTheNewOneIsKnownAfterStartingOver) {
  SoloNode solo;
  solo.join();
  replace_input(solo);
  pull(solo);
  replace_output(solo);
  pull(solo);
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
  EXPECT_EQ(solo.counters().duplicates, 1u);
}

// Eight others with the same number may have passed elsewhere.
TEST_F(InputIsAnother, WhatCameOnTheFormerOneIsForgotten) {
  SoloNode solo;
  solo.join();
  pull(solo);
  replace_input(solo);
  replace_output(solo);
  pull(solo);
  EXPECT_EQ(solo.counters().pins_pulled, 2u);
}

// What it has sent back itself may come round on the second line: the same copy is not taken again. (protocol.md
// section 4.10)
TEST_F(InputIsAnother, WhatCameOnAnyIsRememberedIfTheRingFoldsBack) {
  SoloNode solo = folding();
  solo.join();
  replace_input(solo);
  pull(solo);
  replace_output(solo);
  pull(solo);
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
  EXPECT_EQ(solo.counters().doubtful_retries, 1u);
}

TEST(NewIncarnation, ForgetsHowTheHelloBeforeEnded) {
  SoloNode solo{Duration{0}, [](Settings& s) { s.break_grace = 50ms; }};
  solo.run();
  Blocks& node = solo.node();
  node.input_lost(solo.now());
  const Time due = solo.now() + 50ms;
  node.handle_timeout(due);  // the hello that is out ends unconfirmed
  node.output_lost(due);
  node.input_up(0_id, due);
  node.output_up(2_id, due);
  node.run(due);
  EXPECT_EQ(solo.counters().hellos, 2u);
  EXPECT_EQ(node.membership().state(), NodeState::joining);
}

// ---- a whole ring ---------------------------------------------------------------------------

struct ExactlyOnceRing : testing::Test {
  VirtualRing ring{quick(4)};
  void SetUp() override { ASSERT_TRUE(ring.join()); }
};

TEST_F(ExactlyOnceRing, LostReturnsDoNotDeliverTwice) {
  ring.tap(3_id, lose(3, is_data));
  const SendEnded end = outcome_of(ring, 0_id, ring.send(0_id, 1_id, text("a")));
  EXPECT_EQ(end.outcome, Outcome::delivered);
  EXPECT_EQ(end.tries, 4u);
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(text("a")));
}

TEST_F(ExactlyOnceRing, DamageOnAnyLineDoesNotDeliverTwiceOrWrong) {
  for (NodeId line : {0_id, 1_id, 2_id, 3_id}) {
    ring.tap(line, damage(2, 4, is_data));
    const SendEnded end = outcome_of(ring, 0_id, ring.send(0_id, 2_id, text("a")));
    EXPECT_EQ(end.outcome, Outcome::delivered) << int{line};
    EXPECT_EQ(end.tries, 3u);
  }
  EXPECT_THAT(payloads(ring.log(2_id)), ElementsAre(text("a"), text("a"), text("a"), text("a")));
}

TEST_F(ExactlyOnceRing, PinIsPulledOnceUnderRetries) {
  ring.tap(2_id, lose(2, is_interrupt));
  EXPECT_EQ(outcome_of(ring, 0_id, ring.interrupt(0_id, 1_id, 2)).outcome, Outcome::delivered);
  EXPECT_THAT(pins(ring.log(1_id)), ElementsAre(2));
}

TEST_F(ExactlyOnceRing, SourceThatRestartsIsHeardAgain) {
  for (int start = 0; start < 3; ++start) {
    ring.send(0_id, 1_id, text("word " + std::to_string(start)));
    ring.run_for(1500ns);  // taken, not home yet
    ring.kill(0_id);
    ring.start(0_id);
    ASSERT_TRUE(ring.join());
  }
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(text("word 0"), text("word 1"), text("word 2")));
}

TEST_F(ExactlyOnceRing, ReceiverThatRestartsDuringATryEndsItOneWay) {
  ring.tap(3_id, lose(1, is_data));
  const auto token = ring.send(0_id, 1_id, text("a"));
  ring.run_for(10us);
  ring.kill(1_id);
  ring.start(1_id);
  EXPECT_EQ(outcome_of(ring, 0_id, token).outcome, Outcome::lost);
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(text("a")))
      << "what a former incarnation may have taken is not repeated";
}

// Its neighbours restarted or it was frozen; its CPU is the one that took the first try.
TEST_F(ExactlyOnceRing, ReceiverThatWasBypassedDuringATryTakesItOnce) {
  ring.tap(3_id, lose(1, is_data));
  const auto token = ring.send(0_id, 1_id, text("a"));
  ring.run_for(10us);
  ring.freeze(1_id);
  ring.thaw(1_id);
  EXPECT_EQ(outcome_of(ring, 0_id, token).outcome, Outcome::lost);
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(text("a")));
  EXPECT_EQ(outcome_of(ring, 0_id, ring.send(0_id, 1_id, text("b"))).outcome, Outcome::delivered);
}

TEST_F(ExactlyOnceRing, InterruptOfABypassedReceiverPullsOnce) {
  ring.tap(3_id, lose(1, is_interrupt));
  const auto token = ring.interrupt(0_id, 1_id, 2);
  ring.run_for(10us);
  ring.freeze(1_id);
  ring.thaw(1_id);
  outcome_of(ring, 0_id, token);
  EXPECT_EQ(ring.counters(1_id).pins_pulled, 1u);
}

TEST_F(ExactlyOnceRing, SixSendsWithoutAVerdictAreFollowedByANewHello) {
  ring.kill(2_id);
  ring.run_for(1ms);
  const std::uint64_t boot = ring.node(0_id).membership().boot();
  const auto hellos = ring.counters(0_id).hellos;
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(outcome_of(ring, 0_id, ring.send(0_id, 2_id, text("a"))).outcome, Outcome::no_such_node);
  EXPECT_EQ(ring.counters(0_id).hellos, hellos);
  outcome_of(ring, 0_id, ring.send(0_id, 2_id, text("a")));
  ring.run_for(1ms);
  EXPECT_EQ(ring.counters(0_id).hellos, hellos + 1);
  EXPECT_GT(ring.node(0_id).membership().boot(), boot);
  EXPECT_EQ(ring.node(1_id).membership().peers()[0_id].boot, ring.node(0_id).membership().boot());
  EXPECT_EQ(outcome_of(ring, 0_id, ring.send(0_id, 1_id, text("b"))).outcome, Outcome::delivered);
}

TEST_F(ExactlyOnceRing, SixLostSendsAreFollowedByANewHelloToo) {
  const auto hellos = ring.counters(0_id).hellos;
  ring.tap(3_id, lose(6 * 4, is_interrupt));
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(ring.counters(0_id).hellos, hellos);
    EXPECT_EQ(outcome_of(ring, 0_id, ring.interrupt(0_id, 1_id, 1)).outcome, Outcome::lost);
  }
  ring.run_for(1ms);
  EXPECT_EQ(ring.counters(0_id).hellos, hellos + 1);
}

// What users send meanwhile waits for it, and is not cancelled.
TEST(NewHello, ThatWaitsToBeSaidAgainGoesIntoAnOpenChainAtOnce) {
  VirtualRing ring(with(quick(4), [](Settings& s) { s.beacon = 100ms; }));
  ASSERT_TRUE(ring.join());
  ring.tap(1_id, damage(1000000, 5,
                        [](const wire::Slice& slice) { return wire::PacketFields{slice.bytes}.source() == 0_id; }));
  for (int i = 0; i < 6; ++i) outcome_of(ring, 0_id, ring.interrupt(0_id, 1_id, 1));
  const auto token = ring.send(0_id, 2_id, text("a"));
  ring.run_for(10ms);
  ring.cut(1_id);
  const auto in_open_chain = [&] { return ring.node(0_id).membership().state() == NodeState::open_chain; };
  for (int ms = 0; ms < 1000 && !in_open_chain(); ++ms) ring.run_for(1ms);
  const auto hellos = ring.counters(0_id).hellos;
  EXPECT_GT(hellos, 2u);
  ring.run_for(1ms);
  EXPECT_EQ(outcome_of(ring, 0_id, token).outcome, Outcome::unconfirmed);
  EXPECT_EQ(ring.counters(0_id).hellos, hellos);
}

TEST_F(ExactlyOnceRing, VerdictInBetweenResetsTheCount) {
  const auto hellos = ring.counters(0_id).hellos;
  for (int round = 0; round < 3; ++round) {
    ring.kill(2_id);
    ring.run_for(1ms);
    for (int i = 0; i < 5; ++i) outcome_of(ring, 0_id, ring.send(0_id, 2_id, text("a")));
    ring.start(2_id);
    ASSERT_TRUE(ring.join());
    EXPECT_EQ(outcome_of(ring, 0_id, ring.send(0_id, 2_id, text("b"))).outcome, Outcome::delivered);
  }
  EXPECT_EQ(ring.counters(0_id).hellos, hellos);
}

TEST_F(ExactlyOnceRing, NewHelloWaitsForTheInterruptSlot) {
  ring.kill(2_id);
  ring.run_for(1ms);
  for (int i = 0; i < 5; ++i) outcome_of(ring, 0_id, ring.send(0_id, 2_id, text("a")));
  const auto hellos = ring.counters(0_id).hellos;
  ring.tap(3_id, lose(1, is_interrupt));
  const auto interrupt = ring.interrupt(0_id, 1_id, 1);
  outcome_of(ring, 0_id, ring.send(0_id, 2_id, text("a")));
  ring.run_for(50ms);
  EXPECT_EQ(ring.counters(0_id).hellos, hellos);
  EXPECT_EQ(outcome_of(ring, 0_id, interrupt).outcome, Outcome::delivered);
  ring.run_for(1ms);
  EXPECT_EQ(ring.counters(0_id).hellos, hellos + 1);
}

TEST_F(ExactlyOnceRing, NodeThatWasBypassedCancelsItsSendsAndStartsOver) {
  ring.tap(0_id, lose(99, is_data));
  const auto out = ring.send(0_id, 2_id, text("old"));
  const auto queued = ring.send(0_id, 2_id, text("older"), 3);
  ring.run_for(10us);
  const std::uint64_t boot = ring.node(0_id).membership().boot();
  ring.freeze(0_id);
  ring.run_for(1s);
  ring.tap(0_id, nullptr);
  ring.thaw(0_id);
  ASSERT_TRUE(ring.join());
  EXPECT_EQ(outcome_of(ring, 0_id, out).outcome, Outcome::cancelled);
  EXPECT_EQ(outcome_of(ring, 0_id, queued).outcome, Outcome::cancelled);
  EXPECT_GT(ring.node(0_id).membership().boot(), boot);
  EXPECT_EQ(ring.node(2_id).membership().peers()[0_id].boot, ring.node(0_id).membership().boot());
  EXPECT_THAT(ring.log(2_id).packets, IsEmpty());
}

}  // namespace
}  // namespace limb_ring::core
