// What the judge of the ring's promises finds in what it is told.
#include "judge/judge_test.h"

namespace limb_ring::promises {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

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

// What is taken is found to be the lost one, since its end is not seen yet; so each later one is found to be the one
// before it. The last one seems not to have come, and the lost one is long forgotten.
TEST_F(JudgeTest, aStreamOfEqualDataBehindALostOneBreaksNothing) {
  ask(1, 2, 5, 77);
  take(2, 1, 77);
  end(1, 2, 5, Outcome::lost, 4);
  ask(1, 2, 6, 77);
  end(1, 2, 6, Outcome::delivered);
  for (std::uint32_t token = 7; token < 40; ++token) {
    ask(1, 2, token, 77);
    take(2, 1, 77);
    end(1, 2, token, Outcome::delivered);
    rounds(2);
  }
  rounds(100);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_EQ(unjudged(Unjudged::alike), 1u);
}

// What comes next is found to be one that a reset has thrown away; so each later one is found to be the one before it.
TEST_F(JudgeTest, aStreamOfEqualDataBehindAFlushBreaksNothing) {
  for (std::uint32_t token = 5; token < 8; ++token) {
    ask(1, 2, token, 77);
    end(1, 2, token, Outcome::delivered);
  }
  judge.see(2, of(Kind::flushed));
  rounds(4);
  for (std::uint32_t token = 8; token < 40; ++token) {
    deliver_equal(1, 2, token);
    rounds(2);
  }
  rounds(100);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, equalDataThatNeverCameIsNamedAlsoLongAfterAFlush) {
  judge.see(2, of(Kind::flushed));
  rounds(4);
  for (std::uint32_t token = 8; token < 40; ++token) {
    deliver_equal(1, 2, token);
    rounds(2);
  }
  ask(1, 2, 40, 77);
  end(1, 2, 40, Outcome::delivered);
  rounds(10);
  EXPECT_THAT(broken(), ElementsAre(Promise::true_result));
}

// The first one was taken by the receiver's former life, and its retry by the next one.
TEST_F(JudgeTest, equalDataBehindARetryToARestartedReceiverBreaksNothing) {
  ask(1, 2, 5, 77);
  judge.ends(2);
  begins(2);
  rounds(3);
  ask(1, 2, 6, 77);
  end(1, 2, 5, Outcome::delivered, 2);
  take(2, 1, 77);
  end(1, 2, 6, Outcome::delivered);
  rounds(60);
  EXPECT_THAT(broken(), IsEmpty());
}

// Node 3 had no room for the first one. What is seen at the source is told before what is seen at the receivers.
TEST_F(JudgeTest, equalBroadcastsBehindOneThatSomeRefusedBreakNothing) {
  for (std::uint32_t token = 5; token < 40; ++token) {
    ask(1, kAll, token, 77);
    end(1, kAll, token, token == 5 ? Outcome::refused : Outcome::delivered);
    ask(1, kAll, 100 + token, 78);
    for (const std::uint8_t id : {2, 3}) {
      take(id, 1, 77, kAll, Kind::passed);
      if (id != 3 || token != 5) take(id, 1, 77, kAll);
      take(id, 1, 78, kAll, Kind::passed);
      take(id, 1, 78, kAll);
    }
    end(1, kAll, 100 + token, Outcome::delivered);
    rounds(2);
  }
  rounds(100);
  EXPECT_THAT(broken(), IsEmpty());
}

// What comes first is found to be the first send that was seen, so each later one is found to be the one behind it,
// until no other can be under way any more.
TEST_F(JudgeTest, aStreamOfEqualDataBehindOneThatWasAskedForUnseenBreaksNothing) {
  judge.lost(1, 10);
  ask(1, 2, 5, 77);
  take(2, 1, 77);
  for (std::uint32_t token = 6; token < 66; ++token) {
    ask(1, 2, token, 77);
    take(2, 1, 77);
    end(1, 2, token - 1, Outcome::delivered);
    rounds(1);
  }
  take(2, 1, 77);
  end(1, 2, 65, Outcome::delivered);
  rounds(40);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, sendsThatWereCancelledBeforeTheyWereSentExcuseNothing) {
  for (std::uint32_t token = 5; token < 8; ++token) {
    ask(1, 2, token, 77);
    end(1, 2, token, Outcome::cancelled, 0);
  }
  ask(1, 2, 8, 77);
  end(1, 2, 8, Outcome::delivered);
  rounds(10);
  EXPECT_THAT(broken(), ElementsAre(Promise::true_result));
}

TEST_F(JudgeTest, aLostOneWithDataOfItsOwnThatIsTakenTwiceIsNamedAllTheSame) {
  ask(1, 2, 5);
  take(2, 1, 5);
  end(1, 2, 5, Outcome::lost, 4);
  take(2, 1, 5);
  rounds(10);
  EXPECT_THAT(broken(), ElementsAre(Promise::exactly_once));
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

// Of a daemon that was started again, which counts its tokens from 1: chaos over UDP, seed 511, after 935 s.
TEST_F(JudgeTest, theResultOfASendThatWasAskedForBeforeWeObservedIsNotTakenForASecondOneOfAFormerLife) {
  deliver(1, 2, 5);
  judge.ends(1);
  begins(1);
  end(1, 2, 5, Outcome::delivered);
  EXPECT_THAT(broken(), IsEmpty());
  EXPECT_EQ(unjudged(Unjudged::source_unknown), 1u);
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
  EXPECT_EQ(unjudged(Unjudged::receiver_restarted), 0u);
}

TEST_F(JudgeTest, aReaderThatPausedForAMinuteSeesNodesFromThenOn) {
  now += 60'000'000'000;
  judge.lost(1, 100'000);
  judge.lost(2, 100'000);
  end(1, 2, 5, Outcome::delivered);  // what was asked for meanwhile was lost
  take(2, 1, 6);
  rounds(10);
  end(1, 2, 6, Outcome::delivered);
  rounds(10);
  EXPECT_THAT(broken(), IsEmpty());
  rounds(200);
  take(2, 1, 12345);
  rounds(10);
  EXPECT_THAT(broken(), ElementsAre(Promise::undamaged));
}

TEST_F(JudgeTest, aReaderOfSecondsInOneRoundCannotTellTheirOrder) {
  const auto empty = [this] {
    Observation seen = of(Kind::goes_on);
    seen.detail = 1;
    judge.see(2, seen);
  };
  judge.lost(2, 10);
  empty();
  now += 3'000'000'000;
  empty();
  ask(1, 2, 5);
  end(1, 2, 5, Outcome::delivered);  // all of node 1 is read before all of node 2
  take(2, 1, 5);
  rounds(10);
  EXPECT_THAT(broken(), IsEmpty());
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
