#include "io/output.h"

#include <gmock/gmock.h>

namespace limb_ring::link {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

/// We and three others: candidates 0, 1, 2, and 3 for ourselves.
struct SuccessorOfFour : testing::Test {
  Time now{seconds(100)};
  Successor successor{4, Timing{milliseconds(20), milliseconds(60)}, now};

  std::vector<std::size_t> tried() {
    std::vector<std::size_t> all;
    while (const auto candidate = successor.next(now)) all.push_back(*candidate);
    return all;
  }
  /// All that are tried until nobody is left to try, if nobody but `there` is there.
  std::vector<std::size_t> tried_without_luck() {
    std::vector<std::size_t> all;
    while (const auto candidate = successor.next(now)) {
      all.push_back(*candidate);
      successor.absent(*candidate, now);
    }
    return all;
  }
  void pass(milliseconds time) { now += time; }
  void settle_on(std::size_t candidate) {
    pass(milliseconds(200));
    while (const auto next = successor.next(now)) {
      if (*next == candidate) {
        successor.accepted(candidate, now);
        return;
      }
      successor.absent(*next, now);
    }
    FAIL() << "candidate " << candidate << " was never tried";
  }
  /// Those nearer than it are not there. @return false if it is not asked next
  bool is_asked(std::size_t candidate) {
    while (const auto next = successor.next(now)) {
      if (*next >= candidate) return *next == candidate;
      successor.absent(*next, now);
    }
    return false;
  }
  /// For as long as that is believed, and is asked once more; nobody nearer is there, and nobody beyond is tried.
  void is_busy_for_long(std::size_t candidate) {
    pass(milliseconds(200));
    for (const Time begun = now; is_asked(candidate) && now - begun < Successor::kBelieved; pass(milliseconds(20))) {
      ASSERT_TRUE(successor.says_busy(candidate, now));
      ASSERT_EQ(successor.next(now), std::nullopt);
    }
  }
};

TEST_F(SuccessorOfFour, WaitsForTheConfiguredOneAtTheStart) {
  EXPECT_THAT(tried_without_luck(), ElementsAre(0));
  pass(milliseconds(10));
  EXPECT_THAT(tried_without_luck(), IsEmpty());
  pass(milliseconds(10));
  EXPECT_THAT(tried_without_luck(), ElementsAre(0));
}

TEST_F(SuccessorOfFour, TriesTheOthersInRingOrderWhenPatienceEnds) {
  tried_without_luck();
  pass(milliseconds(200));
  EXPECT_THAT(tried_without_luck(), ElementsAre(0, 1, 2, 3));
}

TEST_F(SuccessorOfFour, TakesTheFirstThatAccepts) {
  tried();
  successor.accepted(0, now);
  EXPECT_EQ(successor.current(), 0u);
  pass(seconds(1));
  EXPECT_THAT(tried(), IsEmpty());
}

TEST_F(SuccessorOfFour, MovesOnAtOnceIfALostOneIsGone) {
  settle_on(0);
  pass(seconds(1));
  successor.lost(Successor::Loss::ended, now);
  EXPECT_THAT(tried_without_luck(), ElementsAre(0, 1, 2, 3));
}

TEST_F(SuccessorOfFour, PassesAFrozenOneOverButKeepsAskingIt) {
  settle_on(0);
  pass(seconds(1));
  successor.lost(Successor::Loss::silent, now);
  EXPECT_THAT(tried(), ElementsAre(0, 1));  // 0 does not answer; 1 may be given its time
  successor.accepted(1, now);
  successor.accepted(0, now);  // thawed
  EXPECT_EQ(successor.current(), 0u);
}

TEST_F(SuccessorOfFour, PassesOverANodeThatDoesNotAnswer) {
  pass(milliseconds(200));
  EXPECT_THAT(tried(), ElementsAre(0));
  pass(milliseconds(50));
  EXPECT_THAT(tried(), IsEmpty());
  pass(milliseconds(10));
  EXPECT_THAT(tried(), ElementsAre(1));
}

TEST_F(SuccessorOfFour, TriesNobodyBeyondALivingNode) {
  settle_on(0);
  pass(seconds(1));
  successor.lost(Successor::Loss::ended, now);
  ASSERT_EQ(successor.next(now), 0u);
  successor.absent(0, now);
  ASSERT_EQ(successor.next(now), 1u);
  successor.busy(1, now);
  EXPECT_THAT(tried(), IsEmpty());
  pass(milliseconds(20));
  EXPECT_THAT(tried_without_luck(), ElementsAre(0, 1, 2, 3));  // until it is found dead
}

TEST_F(SuccessorOfFour, AsksTheBypassedOnesAgainAndGoesBack) {
  settle_on(2);
  pass(milliseconds(20));
  EXPECT_THAT(tried_without_luck(), ElementsAre(0, 1));
  pass(milliseconds(20));
  ASSERT_TRUE(successor.next(now));
  successor.accepted(0, now);
  EXPECT_EQ(successor.current(), 0u);
  pass(seconds(1));
  EXPECT_THAT(tried(), IsEmpty());
}

TEST_F(SuccessorOfFour, WaitsBeforeItReturnsToANodeThatTookANearerUpstream) {
  settle_on(1);
  pass(seconds(1));
  successor.lost(Successor::Loss::replaced, now);
  EXPECT_THAT(tried_without_luck(), ElementsAre(0));
  pass(milliseconds(20));
  EXPECT_EQ(successor.next(now), 0u);
}

TEST_F(SuccessorOfFour, DoesNotRunInCirclesWithOneThatTakesAndDropsUs) {
  settle_on(0);
  successor.lost(Successor::Loss::ended, now);
  EXPECT_THAT(tried(), ElementsAre(1));
}

TEST_F(SuccessorOfFour, TheConfiguredOneThatIsBusyForEverIsPassedOverUntilItAccepts) {
  ASSERT_NO_FATAL_FAILURE(is_busy_for_long(0));
  EXPECT_FALSE(successor.says_busy(0, now));
  EXPECT_EQ(successor.next(now), 1u);
  successor.accepted(1, now);
  pass(milliseconds(100));
  ASSERT_EQ(successor.next(now), 0u) << "it is asked again all the same";
  successor.accepted(0, now);
  EXPECT_EQ(successor.current(), 0u);
}

TEST_F(SuccessorOfFour, AFartherOneThatIsBusyForEverIsPassedOverIfNobodyNearerIsThere) {
  ASSERT_NO_FATAL_FAILURE(is_busy_for_long(1));
  EXPECT_FALSE(successor.says_busy(1, now));
  EXPECT_EQ(successor.next(now), 2u);
}

TEST_F(SuccessorOfFour, AFartherOneIsBelievedWhileANearerOneIsAlive) {
  ASSERT_NO_FATAL_FAILURE(is_busy_for_long(1));
  pass(milliseconds(20));
  ASSERT_EQ(successor.next(now), 0u);
  ASSERT_TRUE(successor.says_busy(0, now)) << "it is back, and another node's neighbour";
  EXPECT_TRUE(successor.says_busy(1, now));
}

}  // namespace
}  // namespace limb_ring::link
