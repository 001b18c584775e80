// A cut line: what is left is an open chain, located by all, unconfirmed, and healing by itself.
#include "core/ring_fixture.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr unsigned kChainNodes = 8;

/// The line from node 2 to node 3 is cut.
struct OpenChain : testing::Test {
  VirtualRing ring{with(quick(kChainNodes), [](Settings& s) { s.beacon = 100ms; })};
  void SetUp() override {
    ASSERT_TRUE(ring.join());
    ring.run_for(50ms);
  }
  void cut() {
    ring.cut(2_id);
    ring.run_for(500ms);
  }
  const Membership& membership(NodeId id) { return ring.node(id).membership(); }
  void expect_all(NodeState state) {
    for (NodeId id{0}; id < kChainNodes; ++id) EXPECT_EQ(membership(id).state(), state) << int{id};
  }
};

TEST_F(OpenChain, IsKnownToAllWithTheBrokenLine) {
  cut();
  expect_all(NodeState::open_chain);
  for (NodeId id{0}; id < kChainNodes; ++id) {
    if (id == 3) continue;
    const wire::Beacon& beacon = membership(id).peers()[3_id].beacon;
    EXPECT_TRUE(beacon.break_known);
    EXPECT_EQ(beacon.break_before, 2);
    EXPECT_EQ(beacon.break_behind, 3);
  }
}

TEST_F(OpenChain, IsToldToAllAtOnceNotWithTheNextBeacon) {
  ring.cut(2_id);
  ASSERT_TRUE(ring.run_until([&] { return membership(3_id).state() == NodeState::open_chain; }, 1s));
  ring.run_for(Duration{20us});  // a lap takes 8 us
  expect_all(NodeState::open_chain);
}

TEST_F(OpenChain, IsNotDeclaredWithinTheGrace) {
  ring.cut(2_id);
  ring.run_for(190ms);
  EXPECT_EQ(membership(3_id).state(), NodeState::up);
  ring.heal(2_id);
  ring.run_for(1s);
  expect_all(NodeState::up);
  EXPECT_EQ(ring.counters(5_id).ended_unconfirmed, 0u);
}

TEST(OpenChainFromTheStart, KnowsTheSizeOfTheRingOnceItIsClosed) {
  VirtualRing ring{with(quick(kChainNodes), [](Settings& s) { s.beacon = 100ms; })};
  ring.cut(2_id);
  ring.run_for(1s);
  const Membership& one = ring.node(5_id).membership();
  ASSERT_EQ(one.state(), NodeState::open_chain);
  EXPECT_EQ(one.ring_size(), 0u);
  ring.heal(2_id);
  ASSERT_TRUE(ring.run_until([&] { return one.state() == NodeState::up; }, 1s));
  EXPECT_EQ(one.ring_size(), kChainNodes);
}

TEST_F(OpenChain, SendsArriveIfAWayIsLeftAndAllEndUnconfirmed) {
  cut();
  EXPECT_EQ(outcome_of(ring, 4_id, ring.send(4_id, 1_id, text("down the chain"))).outcome, Outcome::unconfirmed);
  EXPECT_EQ(outcome_of(ring, 1_id, ring.send(1_id, 4_id, text("no way"))).outcome, Outcome::unconfirmed);
  EXPECT_EQ(outcome_of(ring, 4_id, ring.interrupt(4_id, 1_id, 2)).outcome, Outcome::unconfirmed);
  EXPECT_EQ(ring.counters(4_id).ended_unconfirmed, 2u);
  ring.run_for(10ms);
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(text("down the chain")));
  EXPECT_THAT(pins(ring.log(1_id)), ElementsAre(2));
  EXPECT_THAT(ring.log(4_id).packets, IsEmpty());
}

TEST_F(OpenChain, WhatIsOutstandingEndsUnconfirmedWhenTheBreakIsKnown) {
  ring.cut(2_id);
  const auto token = ring.send(5_id, 1_id, text("a"));
  EXPECT_EQ(outcome_of(ring, 5_id, token, 300ms).outcome, Outcome::unconfirmed);
}

TEST_F(OpenChain, SendsArePaced) {
  cut();
  std::vector<Time> data, interrupts;
  ring.tap(4_id, [&](const wire::Slice& slice, Time now, wire::SliceWriter& arriving) {
    const wire::PacketFields packet{slice.bytes};
    if (packet.source() == 4 && is_interrupt(slice)) interrupts.push_back(now);
    if (packet.source() == 4 && is_data(slice) && !is_control(packet)) data.push_back(now);
    arriving.put(slice.kind, slice.bytes);
  });
  for (int i = 0; i < 5; ++i) ring.send(4_id, 1_id, Bytes(8));
  for (int i = 0; i < 5; ++i) ring.interrupt(4_id, 1_id, 2);
  ring.run_for(2ms);
  ASSERT_EQ(data.size(), 5u);
  ASSERT_EQ(interrupts.size(), 5u);
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_GE(data[i] - data[i - 1], 100us) << i;
    EXPECT_GE(interrupts[i] - interrupts[i - 1], 100us) << i;
  }
}

TEST_F(OpenChain, HealsByItself) {
  cut();
  ring.heal(2_id);
  ring.run_for(1s);
  expect_all(NodeState::up);
  EXPECT_EQ(outcome_of(ring, 1_id, ring.send(1_id, 4_id, text("a"))).outcome, Outcome::delivered);
  for (NodeId id{0}; id < kChainNodes; ++id) {
    EXPECT_EQ(membership(id).ring_size(), kChainNodes);
    EXPECT_FALSE(membership(id).peers()[3_id].beacon.break_known) << "no echo of the old break";
  }
  ring.run_for(2s);
  expect_all(NodeState::up);
}

TEST_F(OpenChain, NumbersAreNewAfterIt) {
  cut();
  for (int i = 0; i < 8; ++i) outcome_of(ring, 1_id, ring.send(1_id, 4_id, text("lost at the cut")));
  const std::uint64_t boot = membership(1_id).boot();
  ring.run_for(1ms);
  ring.heal(2_id);
  ring.run_for(1s);
  EXPECT_GT(membership(1_id).boot(), boot);
  EXPECT_EQ(outcome_of(ring, 1_id, ring.send(1_id, 4_id, text("a"))).outcome, Outcome::delivered);
  EXPECT_THAT(payloads(ring.log(4_id)), ElementsAre(text("a")));
}

TEST_F(OpenChain, ComesAgainForASecondBreakElsewhere) {
  cut();
  ring.heal(2_id);
  ring.run_for(1s);
  ring.cut(6_id);
  ring.run_for(500ms);
  expect_all(NodeState::open_chain);
  EXPECT_EQ(membership(0_id).peers()[7_id].beacon.break_before, 6);
  ring.heal(6_id);
  ring.run_for(1s);
  expect_all(NodeState::up);
}

TEST_F(OpenChain, TwoBreaksLeaveTwoChains) {
  ring.cut(2_id);
  ring.cut(5_id);
  ring.run_for(500ms);
  expect_all(NodeState::open_chain);
  ring.send(3_id, 5_id, text("first part"));
  ring.send(6_id, 2_id, text("second part"));
  ring.run_for(10ms);
  EXPECT_THAT(payloads(ring.log(5_id)), ElementsAre(text("first part")));
  EXPECT_THAT(payloads(ring.log(2_id)), ElementsAre(text("second part")));
  ring.heal(2_id);
  ring.run_for(500ms);
  expect_all(NodeState::open_chain);
  ring.heal(5_id);
  ring.run_for(1s);
  expect_all(NodeState::up);
}

TEST_F(OpenChain, NodeThatStartsInItJoinsAndTakesPackets) {
  ring.kill(5_id);
  cut();
  ring.start(5_id);
  ring.run_for(500ms);
  EXPECT_EQ(membership(5_id).state(), NodeState::open_chain);
  ring.send(4_id, 5_id, text("welcome"));
  ring.send(5_id, 1_id, text("thanks"));
  ring.run_for(10ms);
  EXPECT_THAT(payloads(ring.log(5_id)), ElementsAre(text("welcome")));
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(text("thanks")));
}

TEST_F(OpenChain, NodeBehindTheBreakMayRestart) {
  cut();
  ring.kill(3_id);
  ring.start(3_id);
  ring.run_for(500ms);
  ring.heal(2_id);
  ring.run_for(1s);
  expect_all(NodeState::up);
  EXPECT_EQ(outcome_of(ring, 1_id, ring.send(1_id, 3_id, text("a"))).outcome, Outcome::delivered);
}

TEST_F(OpenChain, NodeBeforeABreakThatSeesItIsInTheChainToo) {
  cut();
  ring.node(2_id).apply(input::OutputLost{Line::first}, ring.now());
  ring.run_for(300ms);
  EXPECT_EQ(membership(2_id).state(), NodeState::open_chain);
  EXPECT_EQ(outcome_of(ring, 2_id, ring.send(2_id, 4_id, text("a"))).reject, Reject::no_way_out);
}

// The output is back, the input is not: what is lost is not this node's place but the line to it.
TEST_F(OpenChain, NodeThatLostBothLinksAndGotOneBackIsInTheChain) {
  ring.cut(2_id);
  ring.node(3_id).apply(input::OutputLost{Line::first}, ring.now());
  ASSERT_EQ(membership(3_id).state(), NodeState::starting);
  ring.run_for(1s);
  EXPECT_EQ(membership(3_id).state(), NodeState::starting) << "no break is known while no line is there";
  ring.node(3_id).apply(input::OutputUp{Line::first, 4_id}, ring.now());
  ring.run_for(300ms);
  EXPECT_EQ(membership(3_id).state(), NodeState::open_chain);
  EXPECT_EQ(outcome_of(ring, 3_id, ring.send(3_id, 5_id, text("a"))).outcome, Outcome::unconfirmed);
  ring.run_for(10ms);
  EXPECT_THAT(payloads(ring.log(5_id)), ElementsAre(text("a")));
  EXPECT_GT(ring.counters(3_id).hellos, 1u) << "the first hello of the new process";
}

}  // namespace
}  // namespace limb_ring::core
