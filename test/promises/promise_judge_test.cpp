// The judge of the ring's promises, told what was seen at three nodes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "promises/promise_judge.h"
#include "wire/outcome.h"
#include "wire/packet.h"

namespace limb_ring::promises {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using wire::Outcome;
using Kind = Observation::Kind;

constexpr std::uint8_t kAll = wire::kBroadcast;
constexpr std::uint8_t kStateUp = 2, kStarting = 0;

struct JudgeTest : testing::Test {
  JudgeTest() {
    for (const std::uint8_t id : {1, 2, 3}) begins(id);
    rounds(40);  // so long that nothing can be under way that was not seen
    deliver(1, 2, 900);
    deliver(2, 3, 901);
    interrupt(1, 3, 902, 0);
    pin(3, 1, 0);
    end_interrupt(1, 3, 902, Outcome::delivered);
    rounds(40);
  }

  void begins(std::uint8_t id) { judge.begins(id, kStateUp, std::chrono::seconds(5), now); }
  /// All nodes go on, and their receive buffers are empty but for those of `full`.
  void rounds(int count, int full = -1) {
    for (int i = 0; i < count; ++i) {
      now += 50'000'000;
      for (const std::uint8_t id : {1, 2, 3}) {
        if (id == silent) continue;
        Observation seen = of(Kind::goes_on);
        seen.detail = id == full ? 0 : 1;
        judge.see(id, seen);
      }
      judge.round_is_over();
    }
  }
  Observation of(Kind kind) {
    Observation seen;
    seen.kind = kind;
    seen.at_ns = now += 1000;
    return seen;
  }
  Observation packet(Kind kind, std::uint8_t to, std::uint32_t content) {
    Observation seen = of(kind);
    seen.destination = to;
    seen.checksum = content;
    seen.size = 8;
    seen.queue = 2;
    return seen;
  }
  void ask(std::uint8_t from, std::uint8_t to, std::uint32_t token, std::uint32_t content = 0) {
    Observation seen = packet(Kind::asked, to, content == 0 ? token : content);
    seen.token = token;
    judge.see(from, seen);
  }
  void end(std::uint8_t from, std::uint8_t to, std::uint32_t token, Outcome outcome, std::uint8_t tries = 1) {
    Observation seen = of(Kind::ended);
    seen.destination = to;
    seen.token = token;
    seen.detail = static_cast<std::uint8_t>(outcome);
    seen.tries = tries;
    judge.see(from, seen);
  }
  void take(std::uint8_t at, std::uint8_t from, std::uint32_t content, std::uint8_t to = 0, Kind kind = Kind::taken) {
    Observation seen = packet(kind, to == 0 ? at : to, content);
    seen.source = from;
    judge.see(at, seen);
  }
  void deliver(std::uint8_t from, std::uint8_t to, std::uint32_t token) {
    ask(from, to, token);
    take(to, from, token);
    end(from, to, token, Outcome::delivered);
  }
  void interrupt(std::uint8_t from, std::uint8_t to, std::uint32_t token, std::uint8_t factor) {
    Observation seen = of(Kind::asked);
    seen.destination = to;
    seen.token = token;
    seen.queue = Observation::kInterrupt;
    seen.channel = factor;
    judge.see(from, seen);
  }
  void end_interrupt(std::uint8_t from, std::uint8_t to, std::uint32_t token, Outcome outcome) {
    Observation seen = of(Kind::ended);
    seen.destination = to;
    seen.token = token;
    seen.queue = Observation::kInterrupt;
    seen.detail = static_cast<std::uint8_t>(outcome);
    seen.tries = 1;
    judge.see(from, seen);
  }
  void pin(std::uint8_t at, std::uint8_t from, std::uint8_t factor) {
    Observation seen = of(Kind::pin);
    seen.source = from;
    seen.destination = at;
    seen.queue = Observation::kInterrupt;
    seen.channel = factor;
    judge.see(at, seen);
  }
  void state(std::uint8_t at, std::uint8_t after) {
    Observation seen = of(Kind::state);
    seen.detail = after;
    judge.see(at, seen);
  }
  std::vector<Promise> broken() const {
    std::vector<Promise> promises;
    for (const Breach& breach : breaches) promises.push_back(breach.promise);
    return promises;
  }
  std::uint64_t unjudged(Unjudged why) const { return judge.counts().unjudged[static_cast<std::size_t>(why)]; }

  std::int64_t now = 1'000'000'000;
  int silent = -1;
  std::vector<Breach> breaches;
  PromiseJudge judge{false, [this](const Breach& breach) { breaches.push_back(breach); }};
};

TEST_F(JudgeTest, aSoundExchangeBreaksNothing) {
  deliver(1, 2, 5);
  ask(1, kAll, 6);
  for (const std::uint8_t id : {2, 3}) {
    take(id, 1, 6, kAll, Kind::passed);
    take(id, 1, 6, kAll);
  }
  end(1, kAll, 6, Outcome::delivered);
  interrupt(1, 3, 7, 4);
  pin(3, 1, 4);
  end_interrupt(1, 3, 7, Outcome::delivered);
  rounds(40);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_EQ(judge.counts().all_unjudged(), 0u) << describe(judge.counts());
  EXPECT_EQ(judge.counts().judged, judge.counts().sends);
}

TEST_F(JudgeTest, whatIsDeliveredAndDoesNotArriveIsNamedWithinASecond) {
  ask(1, 2, 5);
  end(1, 2, 5, Outcome::delivered);
  rounds(10);  // 0.5 s
  ASSERT_THAT(broken(), ElementsAre(Promise::true_result));
  EXPECT_EQ(breaches[0].node, 2);
  EXPECT_EQ(breaches[0].source, 1);
  EXPECT_THAT(breaches[0].what, HasSubstr("DATP of node 1 to 2, priority 2, channel 0, 8 bytes, token 5"));
}

TEST_F(JudgeTest, itMayLieInTheReceiveBuffersForAsLongAsItsCpuReadsNothing) {
  ask(1, 2, 5);
  end(1, 2, 5, Outcome::delivered);
  rounds(100, 2);
  EXPECT_THAT(broken(), IsEmpty());
  take(2, 1, 5);
  rounds(40);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, whatWasFlushedByAResetIsNotJudgedAndCounted) {
  ask(1, 2, 5);
  end(1, 2, 5, Outcome::delivered);
  judge.see(2, of(Kind::flushed));
  rounds(40);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_EQ(unjudged(Unjudged::receiver_restarted), 1u);
}

TEST_F(JudgeTest, aReceiverThatDiedIsNotJudgedAndCounted) {
  ask(1, 2, 5);
  end(1, 2, 5, Outcome::delivered);
  judge.ends(2);
  rounds(40);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_EQ(unjudged(Unjudged::receiver_unknown), 1u);
}

TEST_F(JudgeTest, aPacketThatIsTakenTwiceIsNamed) {
  deliver(1, 2, 5);
  take(2, 1, 5);
  rounds(10);
  ASSERT_THAT(broken(), ElementsAre(Promise::exactly_once));
  EXPECT_THAT(breaches[0].what, HasSubstr("token 5, was taken twice by node 2"));
}

TEST_F(JudgeTest, equalDataThatIsSentTwiceMayBeTakenTwice) {
  ask(1, 2, 5, 77);
  ask(1, 2, 6, 77);
  take(2, 1, 77);
  take(2, 1, 77);
  end(1, 2, 5, Outcome::delivered);
  end(1, 2, 6, Outcome::delivered);
  rounds(40);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, ofEqualDataTheLostOneIsTheOneThatDidNotArrive) {
  ask(1, 2, 5, 77);
  end(1, 2, 5, Outcome::lost, 4);
  ask(1, 2, 6, 77);
  take(2, 1, 77);
  end(1, 2, 6, Outcome::delivered);
  rounds(100);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, anotherOrderIsNamed) {
  ask(1, 2, 5);
  ask(1, 2, 6);
  take(2, 1, 6);
  take(2, 1, 5);
  end(1, 2, 5, Outcome::delivered);
  end(1, 2, 6, Outcome::delivered);
  rounds(10);
  ASSERT_THAT(broken(), ElementsAre(Promise::in_order));
  EXPECT_THAT(breaches[0].what, HasSubstr("token 5, was taken by node 2 after one that was asked for later"));
}

TEST_F(JudgeTest, aPinThatIsPulledTwiceIsNamed) {
  interrupt(1, 3, 7, 4);
  pin(3, 1, 4);
  end_interrupt(1, 3, 7, Outcome::delivered);
  pin(3, 1, 4);
  rounds(10);
  ASSERT_THAT(broken(), ElementsAre(Promise::exactly_once));
  EXPECT_EQ(breaches[0].node, 3);
}

TEST_F(JudgeTest, anInterruptThatIsDeliveredAndPullsNoPinIsNamed) {
  interrupt(1, 3, 7, 4);
  end_interrupt(1, 3, 7, Outcome::delivered);
  rounds(10);
  ASSERT_THAT(broken(), ElementsAre(Promise::true_result));
}

// What the receiver sees may be read before what the source asked for.
TEST_F(JudgeTest, ofEqualInterruptsTheLostOneMayBeMeantAlsoWhereTheReceiverStartsOver) {
  interrupt(1, 3, 14, 0);
  end_interrupt(1, 3, 14, Outcome::lost);
  rounds(20);
  pin(3, 1, 0);
  state(3, kStarting);
  rounds(1);
  interrupt(1, 3, 15, 0);
  end_interrupt(1, 3, 15, Outcome::delivered);
  state(3, kStateUp);
  rounds(10);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, ofEqualInterruptsTheLostOneMayBeMeantAlsoWhereTheReceiverFreezesBehindIt) {
  interrupt(1, 3, 14, 0);
  end_interrupt(1, 3, 14, Outcome::lost);
  rounds(20);
  pin(3, 1, 0);
  rounds(1);
  interrupt(1, 3, 15, 0);
  end_interrupt(1, 3, 15, Outcome::delivered);
  silent = 3;
  rounds(20);
  silent = -1;
  state(3, kStarting);
  rounds(10);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, aPinMayBePulledForTheFirstOfTwoEqualInterruptsAndThenTheReceiverStartsOver) {
  interrupt(1, 3, 14, 0);
  interrupt(1, 3, 15, 0);
  pin(3, 1, 0);
  state(3, kStarting);
  end_interrupt(1, 3, 14, Outcome::lost);
  end_interrupt(1, 3, 15, Outcome::delivered);
  rounds(10);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, anInterruptThatPullsNoPinIsNamedAlsoWhereTheReceiverHadStartedOver) {
  interrupt(1, 3, 14, 0);
  pin(3, 1, 0);
  end_interrupt(1, 3, 14, Outcome::lost);
  rounds(2);
  state(3, kStarting);
  rounds(20);
  interrupt(1, 3, 15, 0);
  end_interrupt(1, 3, 15, Outcome::delivered);
  rounds(10);
  EXPECT_THAT(broken(), ElementsAre(Promise::true_result));
}

TEST_F(JudgeTest, aPacketThatNobodyAskedForIsNamed) {
  deliver(1, 2, 5);
  take(2, 1, 12345);
  rounds(10);
  ASSERT_THAT(broken(), ElementsAre(Promise::undamaged));
}

TEST_F(JudgeTest, aPacketForAnotherNodeIsNamed) {
  ask(1, 2, 5);
  take(3, 1, 5, 2);
  rounds(1);
  ASSERT_THAT(broken(), ElementsAre(Promise::undamaged));
  EXPECT_EQ(breaches[0].node, 3);
}

TEST_F(JudgeTest, aBroadcastThatANodeInTheRingDoesNotTakeIsNamed) {
  ask(1, kAll, 6);
  for (const std::uint8_t id : {2, 3}) take(id, 1, 6, kAll, Kind::passed);
  take(2, 1, 6, kAll);
  end(1, kAll, 6, Outcome::delivered);
  rounds(20);
  ASSERT_THAT(broken(), ElementsAre(Promise::true_result));
  EXPECT_EQ(breaches[0].node, 3);
}

TEST_F(JudgeTest, aBroadcastIsNotJudgedWhileTheRingChanges) {
  ask(1, kAll, 6);
  for (const std::uint8_t id : {2, 3}) take(id, 1, 6, kAll, Kind::passed);
  take(2, 1, 6, kAll);
  end(1, kAll, 6, Outcome::delivered);
  state(3, kStarting);
  rounds(20);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_EQ(unjudged(Unjudged::ring_changed), 1u);
}

TEST_F(JudgeTest, aSecondResultIsNamed) {
  deliver(1, 2, 5);
  end(1, 2, 5, Outcome::delivered);
  ASSERT_THAT(broken(), ElementsAre(Promise::one_result));
}

TEST_F(JudgeTest, aResultThatNeverComesIsNamed) {
  ask(1, 2, 5);
  rounds(100);  // 5 s
  EXPECT_THAT(broken(), IsEmpty());
  rounds(40);
  ASSERT_THAT(broken(), ElementsAre(Promise::one_result));
  EXPECT_THAT(breaches[0].what, HasSubstr("has not ended"));
}

TEST_F(JudgeTest, aNodeThatStandsStillHasNotBrokenThat) {
  ask(1, 2, 5);
  silent = 1;
  rounds(200);
  silent = -1;
  rounds(1);
  end(1, 2, 5, Outcome::lost, 4);
  rounds(20);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, aRefusedPacketThatWasTakenIsNamed) {
  ask(1, 2, 5);
  take(2, 1, 5);
  end(1, 2, 5, Outcome::refused);
  rounds(10);
  ASSERT_THAT(broken(), ElementsAre(Promise::true_result));
}

TEST_F(JudgeTest, aPacketThatCirclesIsNamedAtOnce) {
  Observation seen = of(Kind::circles);
  seen.source = 1;
  seen.size = 3;
  judge.see(2, seen);
  ASSERT_THAT(broken(), ElementsAre(Promise::no_circling));
}

TEST_F(JudgeTest, theSameIsToldOnceASecond) {
  Observation seen = of(Kind::circles);
  seen.source = 1;
  for (int i = 0; i < 100; ++i) judge.see(2, seen);
  EXPECT_EQ(breaches.size(), 1u);
  EXPECT_EQ(judge.counts().breaches, 100u);
}

TEST_F(JudgeTest, lostObservationsSuspendJudgementAndAreCounted) {
  ask(1, 2, 5);
  judge.lost(1, 1000);  // the asking for 6, and the end of 5, among them
  take(2, 1, 6);
  end(1, 2, 6, Outcome::delivered);
  judge.lost(2, 10);
  ask(3, 2, 7);
  end(3, 2, 7, Outcome::delivered);  // its taking may be among those that come too fast
  rounds(60);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_EQ(judge.counts().lost, 1010u);
  EXPECT_GT(judge.counts().all_unjudged(), 2u);
}

TEST_F(JudgeTest, whatOtherNodesSeeFirstWaitsForItsCause) {
  take(2, 1, 5);  // read before what node 1 has written
  rounds(1);
  ask(1, 2, 5);
  end(1, 2, 5, Outcome::delivered);
  rounds(40);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, whatComesBehindOneThatWaitsForItsCauseWaitsToo) {
  take(2, 1, 5);
  rounds(1);
  ask(1, 2, 5);
  ask(1, 2, 6);
  take(2, 1, 6);  // read before the next look at what waits
  end(1, 2, 5, Outcome::delivered);
  end(1, 2, 6, Outcome::delivered);
  rounds(40);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_EQ(judge.counts().all_unjudged(), 0u);
}

// A power cycle: its new process sends before anybody looks at it, and the old one counts as dead a little later.
TEST_F(JudgeTest, whatANodeSendsWhoseDaemonHasGoneIsNotJudged) {
  judge.closes(1);
  take(2, 1, 7);
  rounds(3);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_EQ(judge.counts().all_unjudged(), 1u);
}

// The one before it on the same way waits for its cause, and so does what was taken behind it.
TEST_F(JudgeTest, whatIsTakenButWaitsBehindAnotherIsNotMissing) {
  ask(1, 2, 8);
  end(1, 2, 8, Outcome::delivered);
  rounds(3, /*full=*/2);
  take(2, 1, 7);
  take(2, 1, 8);
  rounds(1);
  EXPECT_THAT(broken(), testing::Each(testing::Ne(Promise::true_result)));
  rounds(3);
  EXPECT_THAT(broken(), testing::Each(testing::Ne(Promise::true_result)));
}

TEST_F(JudgeTest, aReceiverThatRestartedMayTakeOnceMore) {
  ask(1, 2, 5);
  take(2, 1, 5);
  judge.ends(2);
  begins(2);
  rounds(3);
  take(2, 1, 5);  // the retry
  end(1, 2, 5, Outcome::delivered, 2);
  rounds(40);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, sendsOfADeadNodeNeedNoResult) {
  ask(1, 2, 5);
  judge.ends(1);
  take(2, 1, 5);
  rounds(200);
  EXPECT_THAT(broken(), IsEmpty());
}

}  // namespace
}  // namespace limb_ring::promises
