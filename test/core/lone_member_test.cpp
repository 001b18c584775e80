// What one node knows of its ring, and what it says in its hello and beacons. (protocol.md section 8)
#include "core/solo_node.h"

namespace limb_ring::core {
namespace {

/// One node, as SoloNode has it.
struct LoneMember : testing::Test {
  SoloNode solo;
  const Membership& membership() { return solo.node().membership(); }
  NodeState state() { return membership().state(); }
  /// Another node with this one's id says hello, or a former life of this one did.
  void own_id_says_hello(std::uint64_t boot) {
    std::array<std::uint8_t, wire::kHelloSize> bytes;
    wire::encode(wire::Hello{boot, false}, bytes.data());
    solo.receive(wire::SliceKind::whole,
                 Foreign{1, 0xFF}.with_pri(kControlPri).with_hop(3).with({bytes.begin(), bytes.end()}));
  }
  /// A packet to node 2 is sent, and comes home over so many relays.
  void lap(std::uint8_t relays) {
    const Bytes data = text("round");
    solo.line();
    solo.node().send(send_of(1, 1, 2_id, data), solo.now());
    solo.run();
    const auto out = solo.line();
    ASSERT_EQ(out.size(), 1u);
    solo.receive(wire::SliceKind::whole, SoloNode::home(out[0].bytes, 1, relays));
  }
};

TEST_F(LoneMember, KnowsNoRingSizeBeforeAPacketOfItsOwnIsHome) {
  EXPECT_EQ(membership().ring_size(), 0u);
  solo.join();
  EXPECT_EQ(membership().ring_size(), 4u);
}

TEST_F(LoneMember, IsAloneIfItsPacketsPassNobodyElse) {
  solo.join();
  lap(0);
  EXPECT_EQ(state(), NodeState::alone);
  lap(3);
  EXPECT_EQ(state(), NodeState::up);
}

TEST_F(LoneMember, SaysThatItsIdIsDuplicateAtTheThirdSign) {
  solo.join();
  own_id_says_hello(7);
  own_id_says_hello(7);
  EXPECT_EQ(state(), NodeState::up);
  own_id_says_hello(7);
  EXPECT_EQ(state(), NodeState::duplicate_id);
  EXPECT_EQ(solo.counters().duplicate_id_signs, 3u);
}

TEST_F(LoneMember, CountsTheSignsSinceAPacketOfItsOwnWasHome) {
  solo.join();
  own_id_says_hello(7);
  own_id_says_hello(7);
  lap(3);
  own_id_says_hello(7);
  EXPECT_EQ(state(), NodeState::up);
}

TEST_F(LoneMember, KnowsItsOwnFirstHelloHoweverLateItComesHome) {
  solo.join();
  solo.be_bypassed();
  EXPECT_EQ(membership().ring_size(), 0u);
  for (int i = 0; i < 3; ++i) own_id_says_hello(solo.node().settings().boot);
  EXPECT_EQ(solo.counters().duplicate_id_signs, 0u);
}

TEST_F(LoneMember, TakesAReplacedOutputForOneThatWasLost) {
  solo.join();
  solo.node().output_up(3_id, solo.now());
  solo.node().input_lost(solo.now());
  EXPECT_EQ(state(), NodeState::starting) << "both were lost since a packet was home: it was bypassed";
}

TEST_F(LoneMember, TakesAReplacedInputForOneThatWasLost) {
  solo.join();
  solo.node().input_up(3_id, solo.now());
  solo.node().output_lost(solo.now());
  EXPECT_EQ(state(), NodeState::starting) << "both were lost since a packet was home: it was bypassed";
}

TEST_F(LoneMember, CountsWhatIsNeitherHelloNorBeacon) {
  solo.join();
  solo.line();
  solo.receive(wire::SliceKind::whole, Foreign{0, 0xFF}.with_pri(kControlPri).with(text("?")));
  EXPECT_EQ(solo.counters().control_malformed, 1u);
  const Bytes passed = solo.line().at(0).bytes;
  EXPECT_EQ((wire::PacketFields{{passed.data(), passed.size()}}.fbc()), wire::kFbcMax) << "it is taken all the same";
}

TEST_F(LoneMember, SendsItsBeaconWithAnothersIfItIsDueWithinHalfAPeriod) {
  SoloNode talking(Duration{0}, [](Settings& s) { s.beacon = 100ms; });
  talking.join();
  const auto beacons_sent = [&] { return talking.counters().sent_data - talking.counters().hellos; };
  ASSERT_EQ(beacons_sent(), 1u);
  const Bytes first = talking.line().back().bytes;
  const auto said = wire::decode_beacon(wire::PacketFields{{first.data(), first.size()}}.data());
  ASSERT_TRUE(said);
  EXPECT_EQ(said->cpu_boots, 0u) << "no CPU has booted";
  talking.receive(wire::SliceKind::whole, SoloNode::home(first, wire::kFbcMax));
  const auto another_says = [&](std::uint8_t sequence) {
    std::array<std::uint8_t, wire::kBeaconSize> bytes;
    wire::encode(wire::Beacon{}, bytes.data());
    talking.receive(wire::SliceKind::whole,
                    Foreign{0, 0xFF}.with_sequence(sequence).with_pri(kControlPri).with({bytes.begin(), bytes.end()}));
  };
  talking.run_for(Duration{50ms} - Duration{1});
  another_says(1);
  EXPECT_EQ(beacons_sent(), 1u);
  talking.run_for(Duration{1});
  another_says(2);
  EXPECT_EQ(beacons_sent(), 2u);
}

TEST(FoldedOutput, IsSaidInTheNextBeacon) {
  SoloNode solo(Duration{0}, [](Settings& s) {
    s.beacon = 100ms;
    s.fold_back = true;
  });
  solo.join();
  solo.receive(wire::SliceKind::whole, SoloNode::home(solo.line().back().bytes, wire::kFbcMax));
  solo.node().output_lost(solo.now());
  solo.node().output_up(0_id, solo.now(), /*folded=*/true);
  solo.run();  // the one that says that it was lost
  solo.receive(wire::SliceKind::whole, SoloNode::home(solo.line().back().bytes, wire::kFbcMax));
  const Bytes next = solo.line().back().bytes;
  const auto said = wire::decode_beacon(wire::PacketFields{{next.data(), next.size()}}.data());
  ASSERT_TRUE(said);
  EXPECT_EQ(said->output, wire::LinkState::folded);
}

TEST(Hello, ThatCannotGetOntoTheLineIsGivenUpInTime) {
  SoloNode solo;
  solo.node().set_output_ready(false);
  solo.run();
  EXPECT_EQ(solo.node().next_deadline(solo.now()), solo.now() + solo.node().settings().queue_timeout);
}

// Its input was lost before its output was there.
TEST(Hello, GoesIntoAnOpenChainFromANodeThatNeverHadBothLines) {
  NetworkController node(SoloNode::settings({}, [](Settings&) {}), Time{});
  node.apply(input::InputUp{Line::first, 0_id}, Time{});
  node.apply(input::InputLost{Line::first}, Time{});
  node.apply(input::OutputUp{Line::first, 2_id}, Time{});
  node.apply(input::Timeout{}, Time{} + node.settings().break_grace);
  EXPECT_EQ(node.membership().state(), NodeState::open_chain);
  EXPECT_EQ(node.counters().hellos, 1u);
}

// Only two parts of a ring that was folded grow together; others are nodes that start.
TEST(Hello, IsNotSaidAgainIfARingThatWasNeverFoldedGrows) {
  SoloNode solo(Duration{0}, [](Settings& s) { s.fold_back = true; });
  solo.run();
  solo.receive(wire::SliceKind::whole, SoloNode::home(solo.line().at(0).bytes, wire::kFbcMax, 1));
  const Bytes data = text("round");
  solo.node().send(send_of(1, 1, 2_id, data), solo.now());
  solo.run();
  solo.receive(wire::SliceKind::whole, SoloNode::home(solo.line().at(0).bytes, 1, 3));
  solo.run_for(10ms);
  EXPECT_EQ(solo.node().membership().ring_size(), 4u);
  EXPECT_EQ(solo.counters().hellos, 1u);
}

// Said again at once, the hellos of all nodes filled the ring.
TEST(Hello, IsSaidOncePerTryTimeOutIfALineDamagesEveryPacket) {
  VirtualRing ring(quick(4));
  ring.tap(2_id, damage(1000000, 5, is_data));
  ring.run_for(1s);
  for (const NodeId id : {0_id, 1_id, 2_id, 3_id}) EXPECT_EQ(ring.counters(id).hellos, 11u) << int{id};
  ring.tap(2_id, nullptr);
  ring.run_for(ring.node(0_id).settings().send_timeout());
  for (const NodeId id : {0_id, 1_id, 2_id, 3_id})
    EXPECT_EQ(ring.node(id).membership().state(), NodeState::up) << int{id};
}

// It ended lost, as a retry that comes home untaken does, and was said again (seed 1938716889 of test/model).
TEST(Hello, IsHomeAlsoIfItsRetryComesHomeUntaken) {
  SoloNode solo;
  solo.run();
  solo.line();
  solo.run_for(150ms);
  const auto retry = solo.line();
  ASSERT_EQ(retry.size(), 1u);
  solo.receive(wire::SliceKind::whole, SoloNode::home(retry[0].bytes, wire::kFbcUntaken));
  EXPECT_EQ(solo.node().membership().state(), NodeState::up);
  EXPECT_EQ(solo.counters().hellos, 1u);
}

// The one line was lost before the beacon came home, the other one after it (seed 1061 of test/model).
TEST(OpenChainOfOne, IsNotBypassedIfABeaconHasComeHomeBetweenTheLossesOfItsLines) {
  SoloNode solo(Duration{0}, [](Settings& s) { s.beacon = 100ms; });
  solo.join();
  solo.node().input_lost(solo.now());
  solo.run_for(1s);
  ASSERT_EQ(solo.node().membership().state(), NodeState::open_chain);
  solo.node().input_up(0_id, solo.now());
  solo.line();
  solo.run_for(110ms);
  const auto beacons = solo.line();
  ASSERT_FALSE(beacons.empty());
  solo.receive(wire::SliceKind::whole, SoloNode::home(beacons.back().bytes, wire::kFbcMax));
  solo.node().output_lost(solo.now());
  solo.node().output_up(2_id, solo.now());
  EXPECT_EQ(solo.node().membership().state(), NodeState::open_chain);
}

}  // namespace
}  // namespace limb_ring::core
