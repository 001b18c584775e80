// How a send ends, and why.
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::Field;
using testing::IsEmpty;

auto rejected(Reject reason) {
  return AllOf(Field(&SendEnded::outcome, Outcome::rejected), Field(&SendEnded::reject, reason),
               Field(&SendEnded::round_trip, Duration{0}));
}

struct Sending : testing::Test {
  VirtualRing ring{quick(4)};
  void SetUp() override { ASSERT_TRUE(ring.join()); }
  SendEnded send(NodeId from, NodeId to, const Bytes& data, std::uint8_t priority = 0, std::uint8_t channel = 0) {
    return outcome_of(ring, from, ring.send(from, to, data, priority, channel));
  }
};

TEST_F(Sending, TakenByItsDestinationIsDelivered) {
  EXPECT_EQ(send(0_id, 2_id, text("knee")).outcome, Outcome::delivered);
  EXPECT_THAT(payloads(ring.log(2_id)), ElementsAre(text("knee")));
  for (NodeId other : {0_id, 1_id, 3_id}) EXPECT_THAT(ring.log(other).packets, IsEmpty());
}

TEST_F(Sending, ReceiverIsToldWhoSentWhatHow) {
  send(1_id, 3_id, text("x"), 2, 17);
  ASSERT_EQ(ring.log(3_id).packets.size(), 1u);
  const ReceivedPacket& packet = ring.log(3_id).packets[0];
  EXPECT_EQ(packet.source, 1);
  EXPECT_EQ(packet.destination, 3);
  EXPECT_EQ(packet.priority, 2);
  EXPECT_EQ(packet.channel, 17);
}

TEST_F(Sending, RoundTripIsTheTimeFromFirstByteToReturn) {
  EXPECT_EQ(send(0_id, 2_id, text("a")).round_trip, 4us);
  EXPECT_EQ(send(0_id, 1_id, text("a")).round_trip, 4us);
}

TEST_F(Sending, FirstTryIsTheOnlyOneIfNothingFails) { EXPECT_EQ(send(0_id, 2_id, text("a")).tries, 1u); }

// What comes in behind it at the same instant does not go first.
TEST(SendingAlone, WhatHasComeHomeLetsTheNextOneGoAtOnce) {
  SoloNode solo;
  solo.join();
  const Bytes data = text("a");
  solo.node().send(send_of(1, 1, 2_id, data), solo.now());
  solo.node().send(send_of(1, 2, 2_id, data), solo.now());
  solo.run();
  const auto first = solo.line();
  ASSERT_EQ(first.size(), 1u);
  solo.give(wire::SliceKind::whole, SoloNode::home(first[0].bytes, 5));
  EXPECT_THAT(solo.kinds(), ElementsAre(wire::SliceKind::whole));
}

TEST_F(Sending, ToItselfGoesRoundAndIsTakenAsItReturns) {
  EXPECT_EQ(send(1_id, 1_id, text("me")).outcome, Outcome::delivered);
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(text("me")));
  EXPECT_EQ(ring.log(1_id).packets[0].source, 1);
  EXPECT_EQ(ring.counters(2_id).relayed_data, ring.counters(3_id).relayed_data);
}

TEST_F(Sending, BroadcastIsTakenByAllButItsSource) {
  EXPECT_EQ(send(2_id, wire::kBroadcast, text("all")).outcome, Outcome::delivered);
  for (NodeId other : {0_id, 1_id, 3_id}) EXPECT_THAT(payloads(ring.log(other)), ElementsAre(text("all")));
  EXPECT_THAT(ring.log(2_id).packets, IsEmpty());
}

TEST_F(Sending, NobodyTakesAPacketToADeadNode) {
  ring.kill(2_id);
  ring.run_for(1ms);
  const SendEnded end = send(0_id, 2_id, text("a"));
  EXPECT_EQ(end.outcome, Outcome::no_such_node);
  EXPECT_EQ(end.round_trip, 3us);
  EXPECT_EQ(ring.counters(0_id).ended_no_such_node, 1u);
}

TEST_F(Sending, SizesOf1And512AreSentOthersRejected) {
  EXPECT_EQ(send(0_id, 1_id, Bytes(1)).outcome, Outcome::delivered);
  EXPECT_EQ(send(0_id, 1_id, pattern(512)).outcome, Outcome::delivered);
  EXPECT_EQ(payloads(ring.log(1_id)).back(), pattern(512));
  EXPECT_THAT(send(0_id, 1_id, {}), rejected(Reject::bad_size));
  EXPECT_THAT(send(0_id, 1_id, Bytes(513)), rejected(Reject::bad_size));
}

TEST_F(Sending, WrongArgumentsAreRejectedWithTheirReason) {
  EXPECT_THAT(send(0_id, 4_id, Bytes(1)), rejected(Reject::bad_destination));
  EXPECT_THAT(send(0_id, 1_id, Bytes(1), 4), rejected(Reject::bad_priority));
  EXPECT_THAT(send(0_id, 1_id, Bytes(1), 0, 64), rejected(Reject::bad_channel));
  EXPECT_THAT(send(0_id, 1_id, Bytes(1), 0, 1), rejected(Reject::bad_channel));
  EXPECT_THAT(outcome_of(ring, 0_id, ring.interrupt(0_id, 1_id, 8)), rejected(Reject::bad_factor));
  EXPECT_THAT(outcome_of(ring, 0_id, ring.interrupt(0_id, 4_id, 1)), rejected(Reject::bad_destination));
  EXPECT_THAT(outcome_of(ring, 0_id, ring.pull(0_id, 3)), rejected(Reject::input_unwired));
  EXPECT_THAT(outcome_of(ring, 0_id, ring.pull(0_id, 8)), rejected(Reject::input_unwired));
  EXPECT_EQ(ring.counters(0_id).ended_rejected, 8u);
}

TEST(SendingElsewhere, BeforeTheHelloIsHomeIsRejected) {
  SoloNode solo;
  solo.node().send(send_of(1, 1, 2_id, text("a")), solo.now());
  solo.node().interrupt({1, 2, 2_id, wire::Factor{0}}, solo.now());
  solo.run();
  EXPECT_THAT(solo.ends(), ElementsAre(rejected(Reject::not_in_ring), rejected(Reject::not_in_ring)));
}

TEST_F(Sending, EveryTryLostEndsLost) {
  ring.tap(1_id, lose(99, is_data));
  const SendEnded end = send(0_id, 1_id, text("a"));
  EXPECT_EQ(end.outcome, Outcome::lost);
  EXPECT_EQ(end.tries, 4u);
  EXPECT_EQ(end.round_trip, Duration{0});
  EXPECT_EQ(ring.counters(0_id).ended_lost, 1u);
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(text("a"))) << "it may have arrived, never twice";
}

TEST_F(Sending, ThatCannotGetOntoTheLineIsRejectedInTime) {
  ring.node(0_id).set_output_ready(Line::first, false);
  EXPECT_THAT(send(0_id, 1_id, text("a")), rejected(Reject::no_way_out));
  EXPECT_THAT(outcome_of(ring, 0_id, ring.interrupt(0_id, 1_id, 1)), rejected(Reject::no_way_out));
  EXPECT_EQ(ring.counters(0_id).ended_rejected, 2u);
  ring.node(0_id).set_output_ready(Line::first, true);
  EXPECT_EQ(send(0_id, 1_id, text("b")).outcome, Outcome::delivered);
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(text("b")));
}

TEST_F(Sending, CancelledEndsAtOnceAndIsNotRepeated) {
  ring.tap(3_id, lose(1, is_data));
  const auto out = ring.send(0_id, 1_id, text("out"));
  const auto queued = ring.send(0_id, 1_id, text("queued"));
  ring.run_for(10us);
  ring.node(0_id).apply(input::Cancel{sim::VirtualRing::kUser}, ring.now());
  EXPECT_EQ(outcome_of(ring, 0_id, out).outcome, Outcome::cancelled);
  EXPECT_EQ(outcome_of(ring, 0_id, queued).outcome, Outcome::cancelled);
  ring.run_for(1s);
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(text("out")));
  EXPECT_EQ(ring.counters(0_id).retries, 0u);
  EXPECT_EQ(ring.log(0_id).events.size(), 4u) << "joining, up, and one end each";
}

TEST_F(Sending, CpuResetCancelsItsSendsAndEmptiesItsBuffers) {
  ring.set_cpu_reads(0_id, false);
  send(3_id, 0_id, text("stale command"));
  ring.node(0_id).apply(input::Send{send_of(7, 99, 1_id, text("t"))}, ring.now());
  const auto own = ring.send(0_id, 1_id, text("own"));
  ring.reset_cpu(0_id);
  EXPECT_EQ(outcome_of(ring, 0_id, own).outcome, Outcome::cancelled);
  EXPECT_EQ(outcome_of(ring, 0_id, 99).outcome, Outcome::delivered) << "a tool's send goes on";
  EXPECT_EQ(ring.node(0_id).received_waiting(), 0u);
  EXPECT_EQ(ring.counters(0_id).flushed_on_reset, 1u);
}

TEST_F(Sending, EveryEndIsCountedUnderItsName) {
  send(0_id, 1_id, Bytes(1));
  send(0_id, 4_id, Bytes(1));
  outcome_of(ring, 0_id, ring.interrupt(0_id, 1_id, 7));
  EXPECT_EQ(ring.counters(0_id).ended_delivered, 1u);
  EXPECT_EQ(ring.counters(0_id).ended_rejected, 1u);
  EXPECT_EQ(ring.counters(0_id).ended_refused, 1u);
}

// A daemon that is woken late puts a packet where it would have been; only what had waited for the line begins as it
// wakes.
TEST(LateTurn, LeavesAPacketAtTheInstantItWasAskedFor) {
  SoloNode solo(8ns);
  solo.join();
  solo.node().set_output_ready(false);
  solo.run_for(1us);
  solo.node().set_output_ready(true);
  solo.run();
  const Time asked = solo.now();
  const Bytes data(512);
  solo.node().send(send_of(1, 1, 2_id, data), asked);
  solo.node().run(asked + 1us);
  const Duration words = 8ns * (512 + 4);
  EXPECT_EQ(solo.node().next_deadline(asked + 1us), asked + words);
}

TEST(LateTurn, LeavesTheHelloAtTheInstantTheLinesCameUp) {
  SoloNode solo(1us);
  const Duration words = 1us * (4 + wire::kHelloSize / 4 * 4);
  solo.node().run(solo.now() + 3us);
  for (Event event; solo.node().take_event(solo.now() + 3us, event);) {
  }
  EXPECT_EQ(solo.node().next_deadline(solo.now() + 3us), solo.now() + words);
}

}  // namespace
}  // namespace limb_ring::core
