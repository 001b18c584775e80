// INTPs of one factor are all alike: which one has pulled a pin, the judge has to find out.
#include "judge/judge_test.h"

namespace limb_ring::promises {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST_F(JudgeTest, aPinThatIsPulledTwiceIsNamed) {
  interrupt(1, 3, 7, 4);
  pin(3, 1, 4);
  end_interrupt(1, 3, 7, Outcome::delivered);
  pin(3, 1, 4);
  rounds(10);
  ASSERT_THAT(broken(), ElementsAre(Promise::exactly_once));
  EXPECT_EQ(breaches[0].node, 3);
}

TEST_F(JudgeTest, aPinThatIsPulledTwiceIsNamedEvenIfItsNodeStartsOverInBetween) {
  interrupt(1, 3, 7, 4);
  pin(3, 1, 4);
  state(3, kStarting);
  rounds(2);
  pin(3, 1, 4);
  end_interrupt(1, 3, 7, Outcome::lost);
  state(3, kStateUp);
  rounds(10);
  ASSERT_THAT(broken(), ElementsAre(Promise::exactly_once));
}

TEST_F(JudgeTest, anInterruptThatIsDeliveredAndPullsNoPinIsNamed) {
  interrupt(1, 3, 7, 4);
  end_interrupt(1, 3, 7, Outcome::delivered);
  rounds(10);
  ASSERT_THAT(broken(), ElementsAre(Promise::true_result));
}

// What the receiver sees may be read before what the source asked for.
TEST_F(JudgeTest, ofEqualInterruptsTheLostOneMayBeMeantEvenIfTheReceiverStartsOver) {
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

TEST_F(JudgeTest, ofEqualInterruptsTheLostOneMayBeMeantEvenIfTheReceiverFreezesBehindIt) {
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

TEST_F(JudgeTest, ofEqualInterruptsTheLostOneMayBeMeantEvenIfTheSourceDiesBehindIt) {
  pull_for_the_second_of_two();
  end_interrupt(1, 3, 15, Outcome::delivered);
  judge.ends(1);
  rounds(10);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, ofEqualInterruptsTheLostOneMayBeMeantEvenIfTheOtherEndsMuchLater) {
  pull_for_the_second_of_two();
  rounds(20);
  end_interrupt(1, 3, 15, Outcome::delivered);
  rounds(10);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, ofAnInterruptToAllAndOneToANodeTheLostOneMayBeMeantEvenIfTheOtherEndsMuchLater) {
  interrupt(1, kAll, 14, 0);
  interrupt(1, 3, 15, 0);
  pin(3, 1, 0);
  end_interrupt(1, kAll, 14, Outcome::lost);
  rounds(100);
  end_interrupt(1, 3, 15, Outcome::delivered);
  rounds(10);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, ofAnInterruptToANodeAndOneToAllTheLostOneMayBeMeantEvenIfTheOtherEndsMuchLater) {
  interrupt(1, 3, 14, 0);
  interrupt(1, kAll, 15, 0);
  Observation passes = of(Kind::passed);
  passes.source = 1;
  passes.destination = kAll;
  passes.queue = Observation::kInterrupt;
  judge.see(3, passes);
  pin(3, 1, 0);
  rounds(1);
  end_interrupt(1, 3, 14, Outcome::lost);
  rounds(20);
  end_interrupt(1, kAll, 15, Outcome::delivered);
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

TEST_F(JudgeTest, aPinIsOfTheInterruptThatIsOutRatherThanOfOneThatNobodyTook) {
  interrupt(1, 3, 14, 0);
  end_interrupt(1, 3, 14, Outcome::no_such_node);
  rounds(1);
  interrupt(1, 3, 15, 0);
  pin(3, 1, 0);
  rounds(1);
  end_interrupt(1, 3, 15, Outcome::delivered);
  rounds(10);
  EXPECT_THAT(broken(), IsEmpty());
}

TEST_F(JudgeTest, anInterruptThatPullsNoPinIsNamedEvenIfTheReceiverHadStartedOver) {
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

}  // namespace
}  // namespace limb_ring::promises
