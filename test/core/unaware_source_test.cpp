// A node has started, or started over, and not all know it yet: they may repeat what it took before.
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using wire::SliceKind;

/// Node 1 has taken "x" of node 0, has started over, and has joined the open chain behind the broken line 2 -> 3.
struct UnawareSource : testing::Test {
  SoloNode solo{Duration{0}, [](Settings& s) { s.beacon = 100ms; }};
  Bytes hello;

  /// @return FBC that the packet went on with
  std::uint8_t comes(std::uint8_t sequence, std::uint8_t attempt, const char* data = "x") {
    solo.line();
    solo.receive(SliceKind::whole, Foreign{0, 1}.with_sequence(sequence).with_attempt(attempt).with(text(data)));
    const Bytes out = solo.line().at(0).bytes;
    return wire::PacketFields{{out.data(), out.size()}}.fbc();
  }
  void SetUp() override {
    solo.join();
    ASSERT_NE(comes(0, 0), 0);
    ASSERT_THAT(solo.packets(), SizeIs(1));
    solo.receive(SliceKind::interrupt, foreign_interrupt(0, 1, 1, 5, 0));
    ASSERT_EQ(solo.counters().pins_pulled, 1u);
    solo.node().input_lost(solo.now());
    solo.node().output_lost(solo.now());
    solo.node().output_up(2_id, solo.now());
    solo.node().input_up(0_id, solo.now());
    solo.line();
    hear_of_break(solo);
    solo.run_for(1ms);
    for (const auto& slice : solo.line())
      if (slice.bytes.at(3) == 1) hello = hello.empty() ? slice.bytes : hello;
    ASSERT_EQ(solo.node().membership().state(), NodeState::open_chain);
    ASSERT_TRUE(solo.node().membership().joined());
  }
};

TEST_F(UnawareSource, ARetryOfItIsNotAnswered) {
  EXPECT_EQ(comes(0, 1), wire::kFbcUntaken);
  EXPECT_THAT(solo.packets(), IsEmpty());
  EXPECT_EQ(solo.counters().retries_of_unaware_nodes, 1u);
}

TEST_F(UnawareSource, AFirstTryOfItIsTakenAndItsRetryIsKnown) {
  EXPECT_NE(comes(1, 0), wire::kFbcUntaken);
  EXPECT_NE(comes(1, 1), wire::kFbcUntaken);
  EXPECT_THAT(solo.packets(), SizeIs(1));
  EXPECT_EQ(solo.counters().duplicates, 1u);
  EXPECT_EQ(solo.counters().retries_of_unaware_nodes, 0u);
}

TEST_F(UnawareSource, APinIsNotPulledAgainByItsRetry) {
  solo.receive(SliceKind::interrupt, foreign_interrupt(0, 1, 1, 5, 1));
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
  EXPECT_EQ(solo.counters().retries_of_unaware_nodes, 1u);
}

TEST_F(UnawareSource, APinIsPulledByAFirstTryAndNotAgainByItsRetry) {
  solo.receive(SliceKind::interrupt, foreign_interrupt(0, 1, 1, 6, 0));
  EXPECT_EQ(solo.counters().pins_pulled, 2u);
  solo.receive(SliceKind::interrupt, foreign_interrupt(0, 1, 1, 6, 1));
  EXPECT_EQ(solo.counters().pins_pulled, 2u);
  EXPECT_EQ(solo.counters().duplicates, 1u);
}

/// A daemon that was started anew remembers nothing of what its last one took. Its hello is out.
struct UnawareSourceOfANewProcess : testing::Test {
  SoloNode solo;
  Bytes hello;
  /// @return FBC that the INTP went on with
  std::uint8_t pulls(std::uint8_t sequence, std::uint8_t attempt) {
    solo.receive(SliceKind::interrupt, foreign_interrupt(0, 1, 1, sequence, attempt));
    const Bytes out = solo.line().at(0).bytes;
    return wire::PacketFields{{out.data(), out.size()}}.fbc();
  }
  void SetUp() override {
    solo.run();
    hello = solo.line().at(0).bytes;
    ASSERT_EQ(solo.node().membership().state(), NodeState::joining);
  }
};

TEST_F(UnawareSourceOfANewProcess, ARetryOfItIsNotAnsweredInAnOpenChain) {
  hear_of_break(solo);
  solo.run_for(1ms);
  ASSERT_EQ(solo.node().membership().state(), NodeState::open_chain);
  ASSERT_TRUE(solo.node().membership().joined());
  solo.receive(SliceKind::whole, Foreign{0, 1}.with_attempt(1).with(text("x")));
  EXPECT_THAT(solo.packets(), IsEmpty());
  EXPECT_EQ(solo.counters().retries_of_unaware_nodes, 1u);
}

TEST_F(UnawareSourceOfANewProcess, ARetryOfItPullsNoPinUntilTheHelloHasComeHome) {
  EXPECT_EQ(pulls(5, 1), wire::kFbcUntaken);
  EXPECT_EQ(solo.counters().pins_pulled, 0u);
  EXPECT_EQ(solo.counters().retries_of_unaware_nodes, 1u);
  solo.receive(SliceKind::whole, SoloNode::home(hello, wire::kFbcMax));
  solo.line();
  EXPECT_EQ(pulls(5, 2), 1) << "its source has heard of the start, and would not repeat the former's";
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
}

TEST_F(UnawareSourceOfANewProcess, AFirstTryOfItPullsAPinAtOnceAndItsRetryIsKnown) {
  EXPECT_EQ(pulls(5, 0), 1);
  EXPECT_EQ(pulls(5, 1), 1);
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
  EXPECT_EQ(solo.counters().duplicates, 1u);
}

// All know of the start then, and repeat nothing that was under way before.
TEST_F(UnawareSource, ARetryIsTakenOnceTheHelloHasComeHome) {
  ASSERT_FALSE(hello.empty());
  solo.receive(SliceKind::whole, SoloNode::home(hello, wire::kFbcMax));
  EXPECT_NE(comes(2, 1), wire::kFbcUntaken);
  EXPECT_THAT(solo.packets(), SizeIs(1));
}

/// If the ring folds back, node 1 has started and its hello is home. Then it hears of node 0 for the first time:
/// that may have been in the other part of a ring in two parts.
struct UnawareSourceOfTheOtherPart : testing::Test {
  SoloNode solo{Duration{0}, [](Settings& s) { s.fold_back = true; }};
  void SetUp() override {
    solo.join();
    Bytes hello(wire::kHelloSize);
    wire::encode(wire::Hello{50}, hello.data());
    solo.receive(SliceKind::whole, Foreign{0, wire::kBroadcast}.with_pri(kControlPri).with(hello));
  }
};

TEST_F(UnawareSourceOfTheOtherPart, ARetryOfItPullsNoPinWhileItMayBeOfAPacketTakenBefore) {
  solo.run_for(5 * solo.node().settings().send_timeout() - Duration{1});
  solo.receive(SliceKind::interrupt, foreign_interrupt(0, 1, 1, 5, 3));
  EXPECT_EQ(solo.counters().pins_pulled, 0u);
  EXPECT_EQ(solo.counters().retries_of_unaware_nodes, 1u);
}

TEST_F(UnawareSourceOfTheOtherPart, ARetryOfItPullsAPinOnceTheTriesOfPacketsOfThenAreOver) {
  solo.run_for(5 * solo.node().settings().send_timeout());
  solo.receive(SliceKind::interrupt, foreign_interrupt(0, 1, 1, 5, 1));
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
}

}  // namespace
}  // namespace limb_ring::core
