// What becomes of a reset: what the interrupt says, and what the boot number says where that says nothing.
#include "config/watchdog.h"

#include <gmock/gmock.h>

namespace limb_ring::watchdog {
namespace {

using namespace std::chrono_literals;
using core::Outcome;
using testing::HasSubstr;

constexpr Reach kDownstream{true, false};
constexpr Reach kUpstream{false, true};

struct ResetOrderTest : testing::Test {
  static core::SendEnded ended(Outcome outcome) {
    core::SendEnded end;
    end.outcome = outcome;
    return end;
  }
  ResetOrder::Report ends(Outcome outcome) { return order.interrupt_ended(ended(outcome), cpu, now += 1ms); }
  ResetOrder::Report boots() {
    ++cpu.boots;
    return order.cpu_changed(cpu, now += 20ms);
  }

  CpuKnown cpu{1, true, false, true, {}};
  core::Time now{};
  ResetOrder order{cpu, now};
};

TEST_F(ResetOrderTest, IsDoneWhenTheBootNumberRises) {
  EXPECT_FALSE(ends(Outcome::delivered));
  const auto report = boots();
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->success());
  EXPECT_EQ(report->message, "the CPU has booted again");
  EXPECT_EQ(report->boots, 2u);
  EXPECT_EQ(report->lasted, 21ms);
}

// As on a board whose firmware is both, and stores nothing.
TEST_F(ResetOrderTest, IsDoneWhenTheWholeNodeHasBootedAndItsCpuRuns) {
  cpu.node_boot = 7;
  order = ResetOrder(cpu, now);
  EXPECT_FALSE(ends(Outcome::delivered));
  cpu.node_boot = 8;
  EXPECT_FALSE(order.cpu_changed(cpu, now)) << "it still boots";
  cpu.runs = true;
  EXPECT_TRUE(order.cpu_changed(cpu, now)->success());
}

TEST_F(ResetOrderTest, ABootBeforeTheInterruptEndsIsNoAnswerYet) {
  EXPECT_FALSE(boots());
  EXPECT_TRUE(ends(Outcome::delivered)->success());
}

TEST_F(ResetOrderTest, WithoutABootItHasFailed) {
  EXPECT_FALSE(ends(Outcome::delivered));
  const ResetReport report = order.timed_out(now += 3s);
  EXPECT_EQ(report.effect, Effect::none);
  EXPECT_EQ(report.message, "the reset pin was pulled, but no CPU has come back in time");
}

TEST_F(ResetOrderTest, ARefusedInterruptHasDoneNothing) {
  const auto report = ends(Outcome::refused);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->effect, Effect::none);
  EXPECT_EQ(report->message, "the interrupt ended 'refused'");
}

TEST_F(ResetOrderTest, ForAMissingNodeItEndsWithAPlainSentence) {
  EXPECT_EQ(ends(Outcome::no_such_node)->message, "the interrupt ended 'no such node'");
}

TEST_F(ResetOrderTest, AfterALostInterruptTheBeaconTellsWhetherItArrived) {
  EXPECT_FALSE(ends(Outcome::lost));
  const auto report = boots();
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->success());
  EXPECT_THAT(report->message,
              HasSubstr("the interrupt ended 'lost', but the CPU has booted again: seen by its node's beacon"));
}

TEST_F(ResetOrderTest, ALostInterruptWithoutABootLeavesItOpen) {
  EXPECT_FALSE(ends(Outcome::lost));
  EXPECT_EQ(order.timed_out(now += 3s).effect, Effect::unknown);
}

TEST_F(ResetOrderTest, ANodeThatIsNotHeardIsNotWaitedFor) {
  cpu.heard = false;
  const auto report = ends(Outcome::lost);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->effect, Effect::unknown);
}

TEST_F(ResetOrderTest, DownTheOpenChainItMayHaveArrivedAndCannotBeHeard) {
  cpu.reach = kDownstream;
  const auto report = ends(Outcome::unconfirmed);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->effect, Effect::unknown);
  EXPECT_EQ(report->message, "that node cannot be heard from here");
}

TEST_F(ResetOrderTest, UpTheOpenChainNothingArrives) {
  cpu.reach = kUpstream;
  const auto report = ends(Outcome::unconfirmed);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->effect, Effect::none);
  EXPECT_EQ(report->message, "not reset");
}

TEST_F(ResetOrderTest, UnconfirmedInAChainThatHasClosedAgainItIsDecidedByTheBeacon) {
  EXPECT_FALSE(ends(Outcome::unconfirmed));
  EXPECT_TRUE(boots()->success());
}

TEST_F(ResetOrderTest, ACpuThatNobodyRestartsIsNotWaitedFor) {
  const CpuKnown outside{1, /*comes_back=*/false, false, true, {}};
  ResetOrder of_outside(outside, now);
  EXPECT_THAT(of_outside.interrupt_ended(ended(Outcome::delivered), outside, now)->message,
              HasSubstr("nobody restarts it"));
}

}  // namespace
}  // namespace limb_ring::watchdog
