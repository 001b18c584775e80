// Nothing is delivered twice, and what was decided once stays decided.
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using wire::SliceKind;

struct ExactlyOnce : testing::Test {
  explicit ExactlyOnce(bool fold_back = false)
      : solo(Duration{0}, [=](Settings& s) {
          s.receive_buffers = 2;
          s.fold_back = fold_back;
        }) {}
  SoloNode solo;
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
  EXPECT_EQ(solo.node().received_waiting(), 1u);
  EXPECT_EQ(solo.packets().size(), 1u);
  EXPECT_EQ(solo.node().received_waiting(), 0u);
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
  EXPECT_EQ(pass({0, 1, 3}), 2) << "a new number is decided afresh";
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
  Bytes damaged = Foreign{0, 1}.with(text("x"));
  damaged[4] ^= 1;
  solo.receive(SliceKind::whole, damaged);
  solo.line();
  EXPECT_EQ(pass({0, 1, 0, 1}), 2);
  EXPECT_THAT(solo.packets(), ElementsAre(text("x")));
}

// Numbers wrap unseen behind a line that is down for long.
TEST_F(ExactlyOnce, AFirstTryIsNewIfItsNumberWasDecidedLongerAgoThanATimeOut) {
  pass({0, 1, 5}, text("first"));
  solo.run_for(solo.node().settings().send_timeout());
  pass({0, 1, 5}, text("first"));
  EXPECT_EQ(solo.counters().duplicates, 1u);
  solo.run_for(Duration{1});
  pass({0, 1, 5}, text("another"));
  EXPECT_THAT(solo.packets(), ElementsAre(text("first"), text("another")));
}

struct Incarnations : ExactlyOnce {
  using ExactlyOnce::ExactlyOnce;
  static wire::Incarnation of(std::uint64_t boot) { return wire::incarnation_of(boot); }
  std::uint8_t hello(std::uint64_t boot, std::uint8_t sequence = 0) {
    Bytes bytes(wire::kHelloSize);
    wire::encode(wire::Hello{boot}, bytes.data());
    return control(boot, sequence, bytes);
  }
  void beacon(std::uint64_t boot, std::uint8_t sequence) {
    Bytes bytes(wire::kBeaconSize);
    wire::Beacon b;
    b.boot = boot;
    wire::encode(b, bytes.data());
    control(boot, sequence, bytes);
  }
  std::uint8_t data(std::uint64_t boot, const std::string& what, std::uint8_t sequence = 0, std::uint8_t attempt = 0) {
    return pass({0, 1, sequence, attempt, 0, 0, wire::kFbcUntaken, of(boot)}, text(what));
  }
  std::uint8_t interrupt(std::uint64_t boot, std::uint8_t attempt = 0) {
    return pass_interrupt(foreign_interrupt(0, 1, 1, 0, attempt, of(boot)));
  }

 private:
  std::uint8_t control(std::uint64_t boot, std::uint8_t sequence, const Bytes& bytes) {
    return pass({0, wire::kBroadcast, sequence, 0, 0, kControlPri, wire::kFbcUntaken, of(boot)}, bytes);
  }
};

TEST_F(Incarnations, AHelloBeginsNewNumbers) {
  hello(7);
  EXPECT_FALSE(solo.node().membership().peers()[0_id].beacon_heard);
  data(7, "seven");
  hello(7, 1);
  data(7, "seven");
  hello(8);
  data(8, "eight");
  interrupt(8);
  hello(9);
  interrupt(9);
  EXPECT_THAT(solo.packets(), ElementsAre(text("seven"), text("eight")));
  EXPECT_EQ(solo.counters().pins_pulled, 2u);
}

TEST_F(Incarnations, ABeaconBeginsNewNumbersIfTheHelloWasMissed) {
  data(7, "before any word of it");
  beacon(7, 0);
  EXPECT_TRUE(solo.node().membership().peers()[0_id].beacon_heard);
  data(7, "before any word of it", 0, 1);
  beacon(8, 1);
  data(8, "eight");
  EXPECT_THAT(solo.packets(), ElementsAre(text("before any word of it"), text("eight")));
}

TEST_F(Incarnations, APacketBeginsNewNumbersIfHelloAndBeaconWereMissed) {
  beacon(7, 0);
  data(7, "seven");
  data(8, "eight");
  EXPECT_THAT(solo.packets(), ElementsAre(text("seven"), text("eight")));
}

// One INTP pulled its pin twice: the first beacon of the incarnation made the receiver forget that it had.
TEST_F(Incarnations, OneInterruptPullsOnceThoughTheHelloOfItsSourceWasMissed) {
  beacon(1000, 3);
  EXPECT_EQ(interrupt(1001), 1);
  beacon(1001, 1);
  EXPECT_EQ(interrupt(1001, 1), 1) << "the retry has the verdict of the first try";
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
}

TEST_F(Incarnations, APacketOfAnEarlierOneIsRefused) {
  hello(7);
  data(7, "seven");
  hello(8);
  EXPECT_EQ(data(7, "late", 1), 0);
  EXPECT_EQ(interrupt(7), 0);
  EXPECT_EQ(solo.counters().earlier_incarnation, 2u);
  EXPECT_THAT(solo.packets(), ElementsAre(text("seven")));
  EXPECT_EQ(solo.counters().pins_pulled, 0u);
}

TEST_F(Incarnations, AHelloOrBeaconOfAnEarlierOneSaysNothing) {
  hello(8);
  data(8, "eight");
  EXPECT_EQ(hello(7), 0);
  beacon(6, 0);
  EXPECT_EQ(solo.counters().earlier_incarnation, 2u);
  EXPECT_EQ(solo.node().membership().peers()[0_id].boot, 8u);
  EXPECT_EQ(data(8, "eight", 0, 1), 1) << "taken before";
  EXPECT_THAT(solo.packets(), ElementsAre(text("eight")));
}

TEST_F(Incarnations, ABootNumberLowerByAThousandIsEarlierAndByMoreMeansThatTheClockWasSetBack) {
  hello(3000);
  hello(2000);
  EXPECT_EQ(solo.counters().earlier_incarnation, 1u);
  hello(1999);
  EXPECT_EQ(solo.counters().earlier_incarnation, 1u);
  EXPECT_EQ(solo.node().membership().peers()[0_id].boot, 1999u);
}

// Once a beacon has told of an incarnation, one with the same two bits is four later.
TEST_F(Incarnations, APacketOfTheFourthIncarnationAfterTheOneInABeaconIsNew) {
  beacon(1000, 0);
  data(1001, "first");
  beacon(1001, 1);
  beacon(1005, 1);
  data(1005, "another");
  EXPECT_THAT(solo.packets(), ElementsAre(text("first"), text("another")));
}

TEST_F(Incarnations, APacketOfTheFourthIncarnationAfterTheOneInAHelloIsNew) {
  hello(1000);
  data(1000, "first");
  beacon(1004, 1);
  data(1004, "another");
  EXPECT_THAT(solo.packets(), ElementsAre(text("first"), text("another")));
}

// Four incarnations of the source were missed, so that its packet seemed to be of the one that was known.
TEST_F(Incarnations, OneInterruptPullsOnceThoughFourIncarnationsWereMissed) {
  beacon(1000, 3);
  EXPECT_EQ(interrupt(1004), 1);
  beacon(1004, 1);
  EXPECT_EQ(interrupt(1004, 1), 1);
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
}

TEST_F(Incarnations, OneInterruptPullsOnceThoughThisNodesOwnBeaconComesHomeMeanwhile) {
  beacon(1000, 3);
  EXPECT_EQ(interrupt(1004), 1);
  beacon(1004, 1);
  Bytes own(wire::kHelloSize);
  wire::encode(wire::Hello{solo.node().membership().boot()}, own.data());
  solo.receive(SliceKind::whole, Foreign{1, wire::kBroadcast}.with_hop(3).with_pri(kControlPri).with(own));
  EXPECT_EQ(interrupt(1004, 1), 1);
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
}

TEST_F(Incarnations, ARetryIsKnownHoweverOldItsNumberIs) {
  beacon(7, 1);
  data(7, "once");
  interrupt(7);
  solo.run_for(10s);
  EXPECT_NE(data(7, "once", 0, 1), wire::kFbcUntaken);
  EXPECT_EQ(interrupt(7, 1), 1);
  EXPECT_EQ(solo.counters().duplicates, 2u);
}

// Its source had begun four incarnations in the other part of a ring that was broken twice, so the two bits were the
// same: an INTP ended delivered, and no pin was pulled (seed 3720049118).
struct InARingThatFoldsBack : Incarnations {
  InARingThatFoldsBack() : Incarnations(true) {}
};
TEST_F(InARingThatFoldsBack, ARetryOfANumberThatWasDecidedLongAgoIsNotAnswered) {
  beacon(1000, 1);
  data(1000, "taken");
  interrupt(1000);
  solo.run_for(400ms);
  EXPECT_EQ(data(1004, "of another", 0, 1), 1) << "tries go on so long";
  EXPECT_EQ(interrupt(1004, 1), 1);
  EXPECT_EQ(solo.counters().duplicates, 2u);
  solo.run_for(1us);
  EXPECT_EQ(data(1004, "of another", 0, 1), wire::kFbcUntaken);
  EXPECT_EQ(interrupt(1004, 1), wire::kFbcUntaken);
  EXPECT_EQ(solo.counters().doubtful_retries, 2u);
  EXPECT_EQ(solo.counters().duplicates, 2u);
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
  EXPECT_EQ(interrupt(1004), 1) << "a first try is new";
  EXPECT_EQ(solo.counters().pins_pulled, 2u);
}

// A late hello is none, and does not unsettle what the packets of the present one have told.
TEST_F(Incarnations, AHelloOfAnEarlierOneMakesNothingForgotten) {
  hello(8);
  EXPECT_EQ(interrupt(9), 1);
  hello(7);
  beacon(9, 1);
  EXPECT_EQ(interrupt(9, 1), 1);
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
}

// While it was bypassed its source sent on, and the numbers wrapped: a retry of a packet whose first try it missed had
// the verdict of an older one (seed 516208246994).
TEST_F(Incarnations, ANodeThatWasBypassedKnowsNoNumbersOfData) {
  beacon(7, 0);
  EXPECT_NE(data(7, "before"), 0);
  solo.be_bypassed();
  EXPECT_EQ(data(7, "another packet", 0, 1), wire::kFbcUntaken) << "its source may not know of the start";
}

// A process that was restarted may have the same two bits by chance: its hello tells.
TEST_F(Incarnations, AHelloBeginsNewNumbersEvenIfTheTwoBitsAreTheSame) {
  data(4, "four");
  hello(4 + 4);
  data(4 + 4, "eight");
  EXPECT_THAT(solo.packets(), ElementsAre(text("four"), text("eight")));
}

TEST(ExactlyOnceJoining, RefusesUsersDataAndTakesTheRest) {
  SoloNode solo;
  Bytes beacon(wire::kBeaconSize);
  wire::encode(wire::Beacon{}, beacon.data());
  solo.run();
  solo.line();
  solo.receive(SliceKind::whole, Foreign{0, 1}.with(text("x")));
  EXPECT_EQ(solo.line().at(0).bytes[6], 0) << "FBC";
  solo.receive(SliceKind::whole, Foreign{0, wire::kBroadcast}.with_pri(kControlPri).with(beacon));
  solo.receive(SliceKind::interrupt, foreign_interrupt(0, 1, 2));
  EXPECT_EQ(solo.counters().refused_joining, 1u);
  EXPECT_EQ(solo.counters().received_control, 1u);
  EXPECT_EQ(solo.counters().pins_pulled, 1u);
  EXPECT_TRUE(solo.node().membership().peers()[0_id].beacon_heard);
}

TEST(ExactlyOnceJoining, WhatItRefusedThenStaysRefused) {
  SoloNode solo;
  solo.receive(SliceKind::whole, Foreign{0, 1}.with_sequence(3).with(text("x")));
  solo.line();
  solo.node().input_up(0_id, solo.now());  // the hello is said again
  solo.join();
  solo.receive(SliceKind::whole, Foreign{0, 1}.with_sequence(3).with_attempt(1).with(text("x")));
  EXPECT_EQ(solo.line().at(0).bytes[6], 0) << "FBC";
  EXPECT_THAT(solo.packets(), IsEmpty());
}

TEST(ExactlyOnceJoining, OwnPacketsAreOnlyStripped) {
  SoloNode solo;
  solo.run();
  solo.line();
  solo.receive(SliceKind::whole, Foreign{1, 1}.with_hop(3).with(text("of a former process")));
  EXPECT_THAT(solo.line(), IsEmpty());
  EXPECT_THAT(solo.packets(), IsEmpty());
}

// It may have been in the other part of a ring that was broken twice, and a first try taken before this node started.
TEST(UnheardSource, ARetryOfItIsNotAnsweredIfTheRingFoldsBack) {
  SoloNode solo(Duration{0}, [](Settings& s) { s.fold_back = true; });
  solo.join();
  solo.line();
  solo.receive(wire::SliceKind::interrupt, foreign_interrupt(0, 1, 1, 5, 1));
  EXPECT_EQ(solo.counters().retries_of_unheard_nodes, 1u);
  EXPECT_EQ(solo.counters().pins_pulled, 0u);
  const auto out = solo.line();
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ((wire::PacketFields{{out[0].bytes.data(), out[0].bytes.size()}}.fbc()), wire::kFbcUntaken);
  solo.receive(wire::SliceKind::interrupt, foreign_interrupt(0, 1, 1, 6, 0));
  EXPECT_EQ(solo.counters().pins_pulled, 1u) << "a first try is";
}

TEST(UnheardSource, ARetryOfItIsCountedEvenIfItIsForAnother) {
  SoloNode solo(Duration{0}, [](Settings& s) { s.fold_back = true; });
  solo.join();
  solo.receive(SliceKind::whole, Foreign{0, 2}.with_attempt(1).with(text("x")));
  EXPECT_EQ(solo.counters().retries_of_unheard_nodes, 1u);
}

}  // namespace
}  // namespace limb_ring::core
