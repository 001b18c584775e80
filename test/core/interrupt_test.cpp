// Interrupts: pins, inputs, and what overtakes what.
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using wire::SliceKind;

struct Interrupts : testing::Test {
  VirtualRing ring{with(quick(4), [](Settings& s) {
    s.inputs[2] = InterruptInput{3_id, wire::Factor{1}};
    s.inputs[5] = InterruptInput{wire::kBroadcast, wire::Factor{2}};
  })};
  void SetUp() override { ASSERT_TRUE(ring.join()); }
};

TEST_F(Interrupts, PullThePinOfTheirNumberAtTheirDestination) {
  EXPECT_EQ(outcome_of(ring, 0_id, ring.interrupt(0_id, 2_id, 1)).outcome, Outcome::delivered);
  EXPECT_THAT(pins(ring.log(2_id)), ElementsAre(1));
  for (NodeId other : {0_id, 1_id, 3_id}) EXPECT_THAT(pins(ring.log(other)), IsEmpty());
}

TEST_F(Interrupts, PinSaysWhoPulledIt) {
  outcome_of(ring, 3_id, ring.interrupt(3_id, 2_id, 1));
  EXPECT_EQ(std::get<PinPulled>(ring.log(2_id).events.back().what).source, 3);
}

TEST_F(Interrupts, BroadcastPullsThePinOfAllOthers) {
  EXPECT_EQ(outcome_of(ring, 0_id, ring.interrupt(0_id, wire::kBroadcast, 2)).outcome, Outcome::delivered);
  for (NodeId other : {1_id, 2_id, 3_id}) EXPECT_THAT(pins(ring.log(other)), ElementsAre(2));
  EXPECT_THAT(pins(ring.log(0_id)), IsEmpty());
}

TEST_F(Interrupts, MayGoToTheirOwnNode) {
  EXPECT_EQ(outcome_of(ring, 1_id, ring.interrupt(1_id, 1_id, 0)).outcome, Outcome::delivered);
  EXPECT_THAT(pins(ring.log(1_id)), ElementsAre(0));
}

TEST_F(Interrupts, UnwiredPinRefusesAndIsNotTriedAgain) {
  const SendEnded end = outcome_of(ring, 0_id, ring.interrupt(0_id, 2_id, 7));
  EXPECT_EQ(end.outcome, Outcome::refused);
  EXPECT_EQ(end.tries, 1u);
  EXPECT_EQ(ring.counters(2_id).refused_unwired, 1u);
  EXPECT_THAT(pins(ring.log(2_id)), IsEmpty());
}

TEST_F(Interrupts, ToADeadNodeFindNobody) {
  ring.kill(2_id);
  ring.run_for(1ms);
  EXPECT_EQ(outcome_of(ring, 0_id, ring.interrupt(0_id, 2_id, 1)).outcome, Outcome::no_such_node);
}

TEST_F(Interrupts, InputsSendWithoutTheCpu) {
  ring.set_cpu_present(1_id, false);
  ring.set_cpu_reads(1_id, false);
  EXPECT_EQ(outcome_of(ring, 1_id, ring.pull(1_id, 2)).outcome, Outcome::delivered);
  EXPECT_THAT(pins(ring.log(3_id)), ElementsAre(1));
  outcome_of(ring, 1_id, ring.pull(1_id, 5));
  EXPECT_THAT(pins(ring.log(0_id)), ElementsAre(2));
}

TEST_F(Interrupts, PinsArePulledAtANodeWhoseCpuIsGone) {
  ring.set_cpu_present(2_id, false);
  EXPECT_EQ(outcome_of(ring, 0_id, ring.interrupt(0_id, 2_id, 0)).outcome, Outcome::delivered);
  EXPECT_THAT(pins(ring.log(2_id)), ElementsAre(0));
}

TEST_F(Interrupts, EachOneToTheSamePinPullsItAgain) {
  for (int i = 0; i < 20; ++i) outcome_of(ring, 0_id, ring.interrupt(0_id, 2_id, 1));
  EXPECT_EQ(pins(ring.log(2_id)).size(), 20u);
}

TEST(InterruptOnALine, IsEmbeddedIntoADatpThatIsBeingSent) {
  VirtualRing ring(gigabit(4));
  ASSERT_TRUE(ring.join());
  ring.send(0_id, 1_id, Bytes(512));
  ring.run_for(1us);
  ring.interrupt(0_id, 1_id, 1);
  Time pin{}, packet{};
  ring.on_event = [&](NodeId id, const Event& e) {
    if (id == 1 && std::holds_alternative<PinPulled>(e.what)) pin = e.at;
  };
  ring.on_packet = [&](NodeId, const ReceivedPacket& p) { packet = p.at; };
  ring.run_for(100us);
  EXPECT_EQ(ring.counters(0_id).embedded_interrupts, 1u);
  EXPECT_LT(pin, packet);
  EXPECT_NE(pin, Time{});
}

TEST(InterruptOnALine, DelayTheDatpAroundThemByTheirOwnLength) {
  VirtualRing ring(gigabit(4));
  ASSERT_TRUE(ring.join());
  const auto data = ring.send(0_id, 1_id, Bytes(512));
  ring.run_for(1us);
  ring.interrupt(0_id, 1_id, 1);
  ring.run_for(1us);
  ring.interrupt(0_id, 1_id, 1);  // goes when the first is home, still inside the DATP
  EXPECT_EQ(outcome_of(ring, 0_id, data).round_trip, 8ns * 524 + 4 * 512ns + 2 * 96ns);
}

// protocol.md section 7.2: behind another INTP, trailer and CRC at every node.
TEST(InterruptOnALine, RoundTripStaysWithinItsBoundUnderFullLoad) {
  VirtualRing ring(gigabit(16));
  ASSERT_TRUE(ring.join());
  Duration most{0};
  unsigned ends = 0;
  ring.on_event = [&](NodeId id, const Event& event) {
    const auto* end = std::get_if<SendEnded>(&event.what);
    if (!end) return;
    if (!end->interrupt) {
      ring.send(id, static_cast<NodeId>((id + 3) % 16), Bytes(512));
    } else {
      ++ends;
      most = std::max(most, end->round_trip);
      ring.at(event.at + Duration{1ns} * ((ends * 7919u) % 5000u),
              [&, id] { ring.interrupt(id, static_cast<NodeId>((id + 5) % 16), 1); });
    }
  };
  for (NodeId id{0}; id < 16; ++id) {
    ring.send(id, static_cast<NodeId>((id + 3) % 16), Bytes(512));
    ring.interrupt(id, static_cast<NodeId>((id + 5) % 16), 1);
  }
  ring.run_for(5ms);
  EXPECT_GT(ends, 4000u);
  EXPECT_LE(most, 10752ns);
  EXPECT_GT(most, 16 * 512ns + 96ns) << "the load was one";
}

}  // namespace
}  // namespace limb_ring::core
