// What a node knows of folds elsewhere in the ring, from beacons. (protocol.md section 8.12)
#include "core/solo_node.h"

namespace limb_ring::core {
namespace {

/// A node in whose ring nothing is folded at itself; beacons come each 100 ms.
struct KnownFold : testing::Test {
  SoloNode solo{Duration{0}, [](Settings& s) {
                  s.fold_back = true;
                  s.beacon = 100ms;
                }};
  void SetUp() override { solo.join(); }
  void hear(std::uint8_t source, std::uint8_t sequence, std::uint64_t boot, const Bytes& message) {
    Foreign packet = Foreign{source, 0xFF}.with_sequence(sequence).with_pri(kControlPri);
    packet.incarnation = wire::incarnation_of(boot);
    solo.receive(wire::SliceKind::whole, packet.with(message));
  }
  void hear_beacon(std::uint8_t source, std::uint8_t sequence, wire::LinkState output) {
    wire::Beacon beacon;
    beacon.boot = 200;
    beacon.input = wire::LinkState::up;
    beacon.output = output;
    Bytes message(wire::kLongBeaconSize);
    message.resize(wire::encode(beacon, message.data()));
    hear(source, sequence, beacon.boot, message);
  }
  void hear_hello(std::uint8_t source, std::uint64_t boot) {
    Bytes message(wire::kHelloSize);
    wire::encode(wire::Hello{boot, true}, message.data());
    hear(source, 0, boot, message);
  }
  NodeState state() { return solo.node().membership().state(); }
};

TEST_F(KnownFold, IsForgottenFivePeriodsAfterTheLastFoldedBeaconThoughThatNodeSaysHello) {
  hear_beacon(2, 0, wire::LinkState::folded);
  EXPECT_EQ(state(), NodeState::folded);
  solo.run_for(450ms);
  hear_hello(2, 201);
  EXPECT_EQ(state(), NodeState::folded);
  solo.run_for(100ms);
  hear_beacon(3, 0, wire::LinkState::up);
  EXPECT_EQ(state(), NodeState::up);
}

/// The second line has stood for the broken first one for so long that all know of the break.
struct FoldedInput : KnownFold {
  void SetUp() override {
    KnownFold::SetUp();
    solo.node().input_lost(solo.now());
    solo.node().input_up(0_id, solo.now(), true);
    solo.run_for(solo.node().settings().break_grace + 100ms);
    bring_beacons_home();
    ASSERT_TRUE(told.back().break_known);
    ASSERT_EQ(told.back().input, wire::LinkState::folded);
    told.clear();
  }
  /// Reads what has been put onto the line, and lets all of it come home.
  void bring_beacons_home() {
    for (auto out = solo.line(); !out.empty(); out = solo.line()) {
      for (const SoloNode::Out& slice : out) {
        const wire::PacketFields packet{{slice.bytes.data(), slice.bytes.size()}};
        if (const auto beacon = wire::decode_beacon(packet.data())) told.push_back(*beacon);
        solo.receive(wire::SliceKind::whole, SoloNode::home(slice.bytes, wire::kFbcMax));
      }
    }
  }
  std::vector<wire::Beacon> told;
};

// The fold node's last word may come before the first line is up here.
TEST_F(FoldedInput, ThatIsLostTellsOfNoBreakUntilItIsFoundAnew) {
  solo.node().input_lost(solo.now());
  solo.node().set_folded(false, false, solo.now());
  solo.run();
  bring_beacons_home();
  ASSERT_FALSE(told.empty());
  for (const wire::Beacon& beacon : told) {
    EXPECT_EQ(beacon.input, wire::LinkState::silent);
    EXPECT_FALSE(beacon.break_known);
  }
  EXPECT_NE(state(), NodeState::open_chain);
  solo.run_for(solo.node().settings().break_grace);
  EXPECT_EQ(state(), NodeState::open_chain);
  EXPECT_EQ(solo.node().membership().broken_line()->behind, 1_id);
}

}  // namespace
}  // namespace limb_ring::core
