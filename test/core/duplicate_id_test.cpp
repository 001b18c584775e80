// Two nodes with one id: both say so, and the others go on.
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;

/// A ring of six in which the node at place 4 believes to be node 3; unwatched, since the promises
/// of a ring suppose that ids differ.
struct DuplicateId : testing::Test {
  sim::VirtualRing ring{with(quick(6), [](Settings& s) {
    s.beacon = 100ms;
    if (s.id == 4) s.id = 3_id;
  })};
  NodeState state(NodeId place) { return ring.node(place).membership().state(); }
};

TEST_F(DuplicateId, BothNodesReportItAndTheOthersWork) {
  ring.run_for(2s);
  EXPECT_EQ(state(3_id), NodeState::duplicate_id);
  EXPECT_EQ(state(4_id), NodeState::duplicate_id);
  EXPECT_EQ(state(0_id), NodeState::up);
  EXPECT_GT(ring.counters(3_id).duplicate_id_signs, 0u);
  expect_counted_up(ring.counters(3_id));
  EXPECT_EQ(outcome_of(ring, 0_id, ring.send(0_id, 5_id, text("a"))).outcome, Outcome::delivered);
  EXPECT_EQ(outcome_of(ring, 3_id, ring.send(3_id, 5_id, text("a"))).reject, Reject::not_in_ring);
}

TEST_F(DuplicateId, EndsWhenTheOtherIsGone) {
  ring.run_for(2s);
  ring.kill(4_id);
  ring.run_for(2s);
  EXPECT_EQ(state(3_id), NodeState::up);
  EXPECT_EQ(outcome_of(ring, 3_id, ring.send(3_id, 0_id, text("a"))).outcome, Outcome::delivered);
  EXPECT_EQ(outcome_of(ring, 0_id, ring.send(0_id, 3_id, text("a"))).outcome, Outcome::delivered);
}

TEST_F(DuplicateId, IsFoundAndLeftByANodeThatWasUpBefore) {
  ring.kill(4_id);
  ring.run_for(2s);
  ASSERT_EQ(state(3_id), NodeState::up);
  const auto waiting = ring.send(3_id, 0_id, text("waiting"), 3);
  ring.start(4_id);
  ring.run_for(2s);
  EXPECT_EQ(state(3_id), NodeState::duplicate_id);
  EXPECT_NE(ring.ended(3_id, waiting), nullptr);
  ring.kill(4_id);
  ring.run_for(2s);
  EXPECT_EQ(state(3_id), NodeState::up);
  EXPECT_EQ(outcome_of(ring, 3_id, ring.send(3_id, 0_id, text("a"))).outcome, Outcome::delivered);
}

TEST_F(DuplicateId, IsLeftThroughJoining) {
  ring.run_for(2s);
  ring.kill(4_id);
  const std::size_t before = ring.log(3_id).events.size();
  ring.run_for(2s);
  std::vector<NodeState> states;
  for (std::size_t i = before; i < ring.log(3_id).events.size(); ++i)
    if (const auto* change = std::get_if<StateChanged>(&ring.log(3_id).events[i].what)) states.push_back(change->after);
  EXPECT_THAT(states, ElementsAre(NodeState::joining, NodeState::up));
}

// Leftovers of an earlier life pass once: fewer than three signs mean nothing.
TEST(DuplicateIdOfANodeThatJoins, IsFoundByTheThirdHelloThatItHasNotSaid) {
  SoloNode solo;
  Bytes hello(wire::kHelloSize);
  wire::encode(wire::Hello{50}, hello.data());
  solo.run();
  for (std::uint8_t sign = 1; sign <= 3; ++sign) {
    EXPECT_EQ(solo.node().membership().state(), NodeState::joining) << "before sign " << int{sign};
    solo.receive(wire::SliceKind::whole,
                 Foreign{1, wire::kBroadcast}.with_sequence(sign).with_hop(3).with_pri(kControlPri).with(hello));
  }
  EXPECT_EQ(solo.node().membership().state(), NodeState::duplicate_id);
}

// The lines of this node stay as they are, so nothing else would have it say hello again.
TEST(DuplicateIdFarAway, IsLeftByTheHelloThatComesHome) {
  sim::VirtualRing ring{with(quick(6), [](Settings& s) {
    s.beacon = 100ms;
    if (s.id == 4) s.id = 1_id;
  })};
  ring.run_for(2s);
  ASSERT_EQ(ring.node(1_id).membership().state(), NodeState::duplicate_id);
  ring.kill(4_id);
  ring.run_for(2s);
  EXPECT_EQ(ring.node(1_id).membership().state(), NodeState::up);
}

TEST_F(DuplicateId, EndsAlsoWhenItsLinksWereLostMeanwhile) {
  ring.run_for(2s);
  ring.kill(5_id);
  ring.kill(4_id);
  ring.kill(2_id);
  ring.run_for(2s);
  EXPECT_EQ(state(3_id), NodeState::up);
}

}  // namespace
}  // namespace limb_ring::core
