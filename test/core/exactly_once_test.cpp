// Nothing is delivered twice, and what was decided once stays decided.
#include "core/solo_node.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using wire::SliceKind;

struct ExactlyOnce : testing::Test {
  SoloNode solo{Duration{0}, [](Settings& s) { s.receive_buffers = 2; }};
  void SetUp() override { solo.join(); }
  /// @return the FBC the packet goes on with
  std::uint8_t pass(const Foreign& packet, const Bytes& data = text("x")) {
    solo.receive(SliceKind::whole, packet.with(data));
    const auto out = solo.line();
    EXPECT_EQ(out.size(), 1u);
    return out.empty() ? 0 : wire::PacketFields{{out[0].bytes.data(), out[0].bytes.size()}}.fbc();
  }
  std::uint8_t pass_interrupt(const Bytes& packet) {
    solo.receive(SliceKind::interrupt, packet);
    return solo.line().at(0).bytes[5];
  }
};

TEST_F(ExactlyOnce, RetryOfATakenPacketIsConfirmedNotDelivered) {
  pass({0, 1, 0, 0});
  EXPECT_EQ(pass({0, 1, 0, 1}), 1);
  EXPECT_EQ(solo.packets().size(), 1u);
  EXPECT_EQ(solo.counters().duplicates, 1u);
}

TEST_F(ExactlyOnce, TakenStaysTakenThoughNoBufferIsFree) {
  pass({0, 1, 0});
  pass({0, 1, 1});
  EXPECT_EQ(pass({0, 1, 1, 1}), 1);
}

TEST_F(ExactlyOnce, RefusedStaysRefusedThoughABufferHasBecomeFree) {
  for (std::uint8_t sequence = 0; sequence < 3; ++sequence) pass({0, 1, sequence});
  EXPECT_EQ(solo.packets().size(), 2u);
  EXPECT_EQ(pass({0, 1, 2, 1}), 0);
  EXPECT_THAT(solo.packets(), IsEmpty());
  EXPECT_EQ(pass({0, 1, 3}), 2) << "a new number is decided anew";
}

TEST_F(ExactlyOnce, UnicastAndBroadcastAreRememberedApart) {
  pass({0, 1, 5}, text("unicast"));
  pass({0, wire::kBroadcast, 5}, text("broadcast"));
  EXPECT_THAT(solo.packets(), ElementsAre(text("unicast"), text("broadcast")));
}

TEST_F(ExactlyOnce, SourcesAreRememberedApart) {
  pass({0, 1, 5}, text("zero"));
  pass({3, 1, 5}, text("three"));
  EXPECT_THAT(solo.packets(), ElementsAre(text("zero"), text("three")));
}

TEST_F(ExactlyOnce, InterruptsHaveAMemoryOfTheirOwn) {
  pass({0, 1, 5});
  EXPECT_EQ(pass_interrupt(foreign_interrupt(0, 1, 1, 5)), 1);
  EXPECT_EQ(pass_interrupt(foreign_interrupt(0, 1, 1, 5, 1)), 1);
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
}

TEST_F(ExactlyOnce, DamagedFirstTryLeavesNoTrace) {
  Bytes damaged = Foreign{0, 1, 0, 0}.with(text("x"));
  damaged[4] ^= 1;
  solo.receive(SliceKind::whole, damaged);
  solo.line();
  EXPECT_EQ(pass({0, 1, 0, 1}), 2);
  EXPECT_THAT(solo.packets(), ElementsAre(text("x")));
}

TEST_F(ExactlyOnce, HelloWithANewBootNumberMakesItForget) {
  const auto hello = [&](std::uint64_t boot, std::uint8_t sequence) {
    Bytes bytes(wire::kHelloSize);
    wire::encode(wire::Hello{boot}, bytes.data());
    pass({0, wire::kBroadcast, sequence, 0, 0, wire::pri_byte(0, 1)}, bytes);
  };
  hello(7, 0);
  pass({0, 1, 0}, text("first life"));
  hello(7, 1);
  pass({0, 1, 0}, text("first life"));
  hello(8, 0);
  pass({0, 1, 0}, text("second life"));
  pass_interrupt(foreign_interrupt(0, 1, 1, 0));
  hello(9, 0);
  pass_interrupt(foreign_interrupt(0, 1, 1, 0));
  EXPECT_THAT(solo.packets(), ElementsAre(text("first life"), text("second life")));
  EXPECT_EQ(solo.counters().pins_pulled, 2u);
}

TEST_F(ExactlyOnce, BeaconOfALifeWhoseHelloWasMissedMakesItForgetToo) {
  const auto beacon = [&](std::uint64_t boot, std::uint8_t sequence) {
    Bytes bytes(wire::kBeaconSize);
    wire::Beacon b;
    b.boot = boot;
    wire::encode(b, bytes.data());
    pass({0, wire::kBroadcast, sequence, 0, 0, wire::pri_byte(0, 1)}, bytes);
  };
  pass({0, 1, 0}, text("before any word of it"));
  beacon(7, 0);
  pass({0, 1, 0, 1}, text("before any word of it"));
  beacon(8, 1);
  pass({0, 1, 0}, text("second life"));
  EXPECT_THAT(solo.packets(), ElementsAre(text("before any word of it"), text("second life")));
}

TEST(ExactlyOnceJoining, RefusesUsersDataAndTakesTheRest) {
  SoloNode solo;
  Bytes beacon(wire::kBeaconSize);
  wire::encode(wire::Beacon{}, beacon.data());
  solo.run();
  solo.line();
  solo.receive(SliceKind::whole, Foreign{0, 1}.with(text("x")));
  EXPECT_EQ(solo.line().at(0).bytes[6], 0) << "FBC";
  solo.receive(SliceKind::whole, Foreign{0, wire::kBroadcast, 0, 0, 0, wire::pri_byte(0, 1)}.with(beacon));
  solo.receive(SliceKind::interrupt, foreign_interrupt(0, 1, 2));
  EXPECT_EQ(solo.counters().refused_joining, 1u);
  EXPECT_EQ(solo.counters().received_control, 1u);
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
  EXPECT_TRUE(solo.node().membership().peers()[0].beacon_heard);
}

TEST(ExactlyOnceJoining, WhatItRefusedThenStaysRefused) {
  SoloNode solo;
  solo.receive(SliceKind::whole, Foreign{0, 1, 3, 0}.with(text("x")));
  solo.line();
  solo.node().input_up(0, solo.now());  // the hello is said again
  solo.join();
  solo.receive(SliceKind::whole, Foreign{0, 1, 3, 1}.with(text("x")));
  EXPECT_EQ(solo.line().at(0).bytes[6], 0) << "FBC";
  EXPECT_THAT(solo.packets(), IsEmpty());
}

TEST(ExactlyOnceJoining, OwnPacketsAreOnlyStripped) {
  SoloNode solo;
  solo.run();
  solo.line();
  solo.receive(SliceKind::whole, Foreign{1, 1, 0, 0, 3}.with(text("of a former life")));
  EXPECT_THAT(solo.line(), IsEmpty());
  EXPECT_THAT(solo.packets(), IsEmpty());
}

// ---- a whole ring ---------------------------------------------------------------------------

struct ExactlyOnceRing : testing::Test {
  VirtualRing ring{quick(4)};
  void SetUp() override { ASSERT_TRUE(ring.join()); }
};

TEST_F(ExactlyOnceRing, LostReturnsDoNotDeliverTwice) {
  ring.tap(3, lose(3, is_data));
  const SendEnded end = outcome_of(ring, 0, ring.send(0, 1, text("a")));
  EXPECT_EQ(end.outcome, Outcome::delivered);
  EXPECT_EQ(end.tries, 4u);
  EXPECT_THAT(payloads(ring.log(1)), ElementsAre(text("a")));
}

TEST_F(ExactlyOnceRing, DamageOnAnyLineDoesNotDeliverTwiceOrWrong) {
  for (NodeId line : {0, 1, 2, 3}) {
    ring.tap(line, damage(2, 4, is_data));
    const SendEnded end = outcome_of(ring, 0, ring.send(0, 2, text("a")));
    EXPECT_EQ(end.outcome, Outcome::delivered) << int{line};
    EXPECT_EQ(end.tries, 3u);
  }
  EXPECT_THAT(payloads(ring.log(2)), ElementsAre(text("a"), text("a"), text("a"), text("a")));
}

TEST_F(ExactlyOnceRing, PinIsPulledOnceUnderRetries) {
  ring.tap(2, lose(2, is_interrupt));
  EXPECT_EQ(outcome_of(ring, 0, ring.interrupt(0, 1, 2)).outcome, Outcome::delivered);
  EXPECT_THAT(pins(ring.log(1)), ElementsAre(2));
}

TEST_F(ExactlyOnceRing, SourceThatRestartsIsHeardAnew) {
  for (int life = 0; life < 3; ++life) {
    ring.send(0, 1, text("word " + std::to_string(life)));
    ring.run_for(1500ns);  // taken, not home yet
    ring.kill(0);
    ring.start(0);
    ASSERT_TRUE(ring.join());
  }
  EXPECT_THAT(payloads(ring.log(1)), ElementsAre(text("word 0"), text("word 1"), text("word 2")));
}

TEST_F(ExactlyOnceRing, ReceiverThatRestartsDuringATryEndsItOneWay) {
  ring.tap(3, lose(1, is_data));
  const auto token = ring.send(0, 1, text("a"));
  ring.run_for(10us);
  ring.kill(1);
  ring.start(1);
  EXPECT_EQ(outcome_of(ring, 0, token).outcome, Outcome::lost);
  EXPECT_THAT(payloads(ring.log(1)), ElementsAre(text("a"))) << "what a former life may have taken is not repeated";
}

// Its neighbours restarted or it was frozen; its CPU is the one that took the first try.
TEST_F(ExactlyOnceRing, ReceiverThatWasBypassedDuringATryTakesItOnce) {
  ring.tap(3, lose(1, is_data));
  const auto token = ring.send(0, 1, text("a"));
  ring.run_for(10us);
  ring.freeze(1);
  ring.thaw(1);
  EXPECT_EQ(outcome_of(ring, 0, token).outcome, Outcome::lost);
  EXPECT_THAT(payloads(ring.log(1)), ElementsAre(text("a")));
  EXPECT_EQ(outcome_of(ring, 0, ring.send(0, 1, text("b"))).outcome, Outcome::delivered);
}

TEST_F(ExactlyOnceRing, InterruptOfABypassedReceiverPullsOnce) {
  ring.tap(3, lose(1, is_interrupt));
  const auto token = ring.interrupt(0, 1, 2);
  ring.run_for(10us);
  ring.freeze(1);
  ring.thaw(1);
  outcome_of(ring, 0, token);
  EXPECT_EQ(ring.counters(1).pins_pulled, 1u);
}

TEST_F(ExactlyOnceRing, SixSendsWithoutAVerdictAreFollowedByANewHello) {
  ring.kill(2);
  ring.run_for(1ms);
  const std::uint64_t boot = ring.node(0).membership().boot();
  const auto hellos = ring.counters(0).hellos;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(outcome_of(ring, 0, ring.send(0, 2, text("a"))).outcome, Outcome::no_such_node);
  EXPECT_EQ(ring.counters(0).hellos, hellos);
  outcome_of(ring, 0, ring.send(0, 2, text("a")));
  ring.run_for(1ms);
  EXPECT_EQ(ring.counters(0).hellos, hellos + 1);
  EXPECT_GT(ring.node(0).membership().boot(), boot);
  EXPECT_EQ(ring.node(1).membership().peers()[0].boot, ring.node(0).membership().boot());
  EXPECT_EQ(outcome_of(ring, 0, ring.send(0, 1, text("b"))).outcome, Outcome::delivered);
}

TEST_F(ExactlyOnceRing, VerdictInBetweenStartsTheCountAnew) {
  const auto hellos = ring.counters(0).hellos;
  for (int round = 0; round < 3; ++round) {
    ring.kill(2);
    ring.run_for(1ms);
    for (int i = 0; i < 5; ++i) outcome_of(ring, 0, ring.send(0, 2, text("a")));
    ring.start(2);
    ASSERT_TRUE(ring.join());
    EXPECT_EQ(outcome_of(ring, 0, ring.send(0, 2, text("b"))).outcome, Outcome::delivered);
  }
  EXPECT_EQ(ring.counters(0).hellos, hellos);
}

TEST_F(ExactlyOnceRing, NewHelloWaitsForTheInterruptSlot) {
  ring.kill(2);
  ring.run_for(1ms);
  for (int i = 0; i < 5; ++i) outcome_of(ring, 0, ring.send(0, 2, text("a")));
  const auto hellos = ring.counters(0).hellos;
  ring.tap(3, lose(1, is_interrupt));
  const auto interrupt = ring.interrupt(0, 1, 1);
  outcome_of(ring, 0, ring.send(0, 2, text("a")));
  ring.run_for(50ms);
  EXPECT_EQ(ring.counters(0).hellos, hellos);
  EXPECT_EQ(outcome_of(ring, 0, interrupt).outcome, Outcome::delivered);
  ring.run_for(1ms);
  EXPECT_EQ(ring.counters(0).hellos, hellos + 1);
}

TEST_F(ExactlyOnceRing, NodeThatWasBypassedCancelsItsSendsAndStartsOver) {
  ring.tap(0, lose(99, is_data));
  const auto out = ring.send(0, 2, text("old"));
  const auto queued = ring.send(0, 2, text("older"), 3);
  ring.run_for(10us);
  const std::uint64_t boot = ring.node(0).membership().boot();
  ring.freeze(0);
  ring.run_for(1s);
  ring.tap(0, nullptr);
  ring.thaw(0);
  ASSERT_TRUE(ring.join());
  EXPECT_EQ(outcome_of(ring, 0, out).outcome, Outcome::cancelled);
  EXPECT_EQ(outcome_of(ring, 0, queued).outcome, Outcome::cancelled);
  EXPECT_GT(ring.node(0).membership().boot(), boot);
  EXPECT_EQ(ring.node(2).membership().peers()[0].boot, ring.node(0).membership().boot());
  EXPECT_THAT(ring.log(2).packets, IsEmpty());
}

}  // namespace
}  // namespace limb_ring::core
