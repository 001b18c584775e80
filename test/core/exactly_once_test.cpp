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

}  // namespace
}  // namespace limb_ring::core
