// A cut line: what is left is an open chain, located by all, unconfirmed, and healing by itself.
#include "core/ring_fixture.h"

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
    ring.cut(2);
    ring.run_for(500ms);
  }
  const Membership& membership(NodeId id) { return ring.node(id).membership(); }
  void expect_all(NodeState state) {
    for (NodeId id = 0; id < kChainNodes; ++id) EXPECT_EQ(membership(id).state(), state) << int{id};
  }
};

TEST_F(OpenChain, IsKnownToAllWithTheBrokenLine) {
  cut();
  expect_all(NodeState::open_chain);
  for (NodeId id = 0; id < kChainNodes; ++id) {
    if (id == 3) continue;
    const wire::Beacon& beacon = membership(id).peers()[3].beacon;
    EXPECT_TRUE(beacon.break_known);
    EXPECT_EQ(beacon.break_before, 2);
    EXPECT_EQ(beacon.break_behind, 3);
  }
}

TEST_F(OpenChain, IsNotDeclaredWithinTheGrace) {
  ring.cut(2);
  ring.run_for(190ms);
  EXPECT_EQ(membership(3).state(), NodeState::up);
  ring.heal(2);
  ring.run_for(1s);
  expect_all(NodeState::up);
  EXPECT_EQ(ring.counters(5).ended_unconfirmed, 0u);
}

TEST_F(OpenChain, SendsArriveWhereAWayIsLeftAndAllEndUnconfirmed) {
  cut();
  EXPECT_EQ(outcome_of(ring, 4, ring.send(4, 1, text("down the chain"))).outcome, Outcome::unconfirmed);
  EXPECT_EQ(outcome_of(ring, 1, ring.send(1, 4, text("no way"))).outcome, Outcome::unconfirmed);
  EXPECT_EQ(outcome_of(ring, 4, ring.interrupt(4, 1, 2)).outcome, Outcome::unconfirmed);
  ring.run_for(10ms);
  EXPECT_THAT(payloads(ring.log(1)), ElementsAre(text("down the chain")));
  EXPECT_THAT(pins(ring.log(1)), ElementsAre(2));
  EXPECT_THAT(ring.log(4).packets, IsEmpty());
}

TEST_F(OpenChain, WhatIsOutstandingEndsUnconfirmedWhenTheBreakIsKnown) {
  ring.cut(2);
  const auto token = ring.send(5, 1, text("a"));
  EXPECT_EQ(outcome_of(ring, 5, token, 300ms).outcome, Outcome::unconfirmed);
}

TEST_F(OpenChain, SendsArePaced) {
  cut();
  std::vector<Time> data, interrupts;
  ring.tap(4, [&](const wire::Slice& slice, Time now, wire::SliceWriter& arriving) {
    const wire::PacketFields packet{slice.bytes};
    if (packet.source() == 4 && is_interrupt(slice)) interrupts.push_back(now);
    if (packet.source() == 4 && is_data(slice) && !is_control(packet)) data.push_back(now);
    arriving.put(slice.kind, slice.bytes);
  });
  for (int i = 0; i < 5; ++i) ring.send(4, 1, Bytes(8));
  for (int i = 0; i < 5; ++i) ring.interrupt(4, 1, 2);
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
  ring.heal(2);
  ring.run_for(1s);
  expect_all(NodeState::up);
  EXPECT_EQ(outcome_of(ring, 1, ring.send(1, 4, text("a"))).outcome, Outcome::delivered);
  for (NodeId id = 0; id < kChainNodes; ++id) {
    EXPECT_EQ(membership(id).ring_size(), kChainNodes);
    EXPECT_FALSE(membership(id).peers()[3].beacon.break_known) << "no echo of the old break";
  }
  ring.run_for(2s);
  expect_all(NodeState::up);
}

TEST_F(OpenChain, NumbersAreNewAfterIt) {
  cut();
  for (int i = 0; i < 8; ++i) outcome_of(ring, 1, ring.send(1, 4, text("lost at the cut")));
  const std::uint64_t boot = membership(1).boot();
  ring.run_for(1ms);
  ring.heal(2);
  ring.run_for(1s);
  EXPECT_GT(membership(1).boot(), boot);
  EXPECT_EQ(outcome_of(ring, 1, ring.send(1, 4, text("a"))).outcome, Outcome::delivered);
  EXPECT_THAT(payloads(ring.log(4)), ElementsAre(text("a")));
}

TEST_F(OpenChain, ComesAgainForASecondBreakElsewhere) {
  cut();
  ring.heal(2);
  ring.run_for(1s);
  ring.cut(6);
  ring.run_for(500ms);
  expect_all(NodeState::open_chain);
  EXPECT_EQ(membership(0).peers()[7].beacon.break_before, 6);
  ring.heal(6);
  ring.run_for(1s);
  expect_all(NodeState::up);
}

TEST_F(OpenChain, TwoBreaksLeaveTwoChains) {
  ring.cut(2);
  ring.cut(5);
  ring.run_for(500ms);
  expect_all(NodeState::open_chain);
  ring.send(3, 5, text("first part"));
  ring.send(6, 2, text("second part"));
  ring.run_for(10ms);
  EXPECT_THAT(payloads(ring.log(5)), ElementsAre(text("first part")));
  EXPECT_THAT(payloads(ring.log(2)), ElementsAre(text("second part")));
  ring.heal(2);
  ring.run_for(500ms);
  expect_all(NodeState::open_chain);
  ring.heal(5);
  ring.run_for(1s);
  expect_all(NodeState::up);
}

TEST_F(OpenChain, NodeThatStartsInItJoinsAndTakesPackets) {
  ring.kill(5);
  cut();
  ring.start(5);
  ring.run_for(500ms);
  EXPECT_EQ(membership(5).state(), NodeState::open_chain);
  ring.send(4, 5, text("welcome"));
  ring.send(5, 1, text("thanks"));
  ring.run_for(10ms);
  EXPECT_THAT(payloads(ring.log(5)), ElementsAre(text("welcome")));
  EXPECT_THAT(payloads(ring.log(1)), ElementsAre(text("thanks")));
}

TEST_F(OpenChain, NodeBehindTheBreakMayRestart) {
  cut();
  ring.kill(3);
  ring.start(3);
  ring.run_for(500ms);
  ring.heal(2);
  ring.run_for(1s);
  expect_all(NodeState::up);
  EXPECT_EQ(outcome_of(ring, 1, ring.send(1, 3, text("a"))).outcome, Outcome::delivered);
}

TEST_F(OpenChain, NodeBeforeABreakItNoticesIsInTheChainToo) {
  cut();
  ring.node(2).output_lost(Line::first, ring.now());
  ring.run_for(300ms);
  EXPECT_EQ(membership(2).state(), NodeState::open_chain);
  EXPECT_EQ(outcome_of(ring, 2, ring.send(2, 4, text("a"))).reject, Reject::no_way_out);
}

// The output is back, the input is not: what is lost is not this node's place but the line to it.
TEST_F(OpenChain, NodeThatLostBothLinksAndGotOneBackIsInTheChain) {
  ring.cut(2);
  ring.node(3).output_lost(Line::first, ring.now());
  ASSERT_EQ(membership(3).state(), NodeState::starting);
  ring.run_for(1s);
  EXPECT_EQ(membership(3).state(), NodeState::starting) << "no break is known while no line is there";
  ring.node(3).output_up(Line::first, 4, ring.now());
  ring.run_for(300ms);
  EXPECT_EQ(membership(3).state(), NodeState::open_chain);
  EXPECT_EQ(outcome_of(ring, 3, ring.send(3, 5, text("a"))).outcome, Outcome::unconfirmed);
  ring.run_for(10ms);
  EXPECT_THAT(payloads(ring.log(5)), ElementsAre(text("a")));
  EXPECT_GT(ring.counters(3).hellos, 1u) << "the first hello of the new process";
}

}  // namespace
}  // namespace limb_ring::core
