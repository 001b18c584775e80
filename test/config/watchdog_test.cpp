// The supervisor's rules under a made-up clock: what it finds, and what it orders.
#include "config/watchdog.h"

#include <gmock/gmock.h>

#include <memory>

namespace limb_ring::watchdog {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using Policy = Watchdog::Policy;
using State = wire::CpuState;

constexpr wire::NodeId kKnee{10};
constexpr core::Duration kMissing = 500ms;

/// One CPU at the knee and its supervisor, which evaluates every 100 ms. Grace 2 s, back-off 1 s, 3 tries.
class WatchdogTest : public testing::Test {
 protected:
  WatchdogTest() { watch(Policy::automatic); }

  void watch(Policy policy) {
    config::SupervisorConfig settings;
    settings.policy = policy;
    settings.grace = 2s;
    settings.backoff = 1s;
    settings.tries = 3;
    watchdog_ = std::make_unique<Watchdog>(settings, kMissing, std::vector<wire::NodeId>{kKnee});
  }

  /// The beacons go on for so long, all saying the same. @return resets ordered meanwhile
  unsigned pass(core::Duration time) {
    unsigned resets = 0;
    for (const core::Time end = now_ + time; now_ < end;) {
      now_ += 100ms;
      if (beacons_) cpu_.heard_at = now_;
      resets += evaluate();
    }
    return resets;
  }

  unsigned evaluate() {
    const Watchdog::Round round = watchdog_->evaluate([this](wire::NodeId) { return cpu_; }, now_);
    for (const auto& finding : round.findings) findings_.push_back(to_string(finding.verdict) + (": " + finding.what));
    EXPECT_THAT(round.resets, testing::Each(kKnee));
    return static_cast<unsigned>(round.resets.size());
  }

  /// Attached and running, its grace over.
  void run_for_long() {
    boot();
    pass(60s);
    findings_.clear();
  }

  void boot() {
    ++cpu_.boots;
    speak();
  }
  void speak() { set(State::running, 20ms); }
  void hang() { set(State::silent, 640ms); }
  void set(State state, std::chrono::milliseconds silent) {
    cpu_.state = state;
    cpu_.silent = silent;
  }
  void reset_fails() {
    const auto failure = watchdog_->reset_ended(kKnee, false, "no CPU has come back in time", now_);
    ASSERT_TRUE(failure);
    findings_.push_back(to_string(failure->verdict) + (": " + failure->what));
  }
  WatchedCpu knee() const { return watchdog_->watched().front(); }
  CpuVerdict verdict() const { return knee().verdict; }

  core::Time now_{};
  CpuSighting cpu_;
  bool beacons_ = true;
  std::unique_ptr<Watchdog> watchdog_;
  std::vector<std::string> findings_;
};

TEST_F(WatchdogTest, ACpuThatSpeaksIsAlive) {
  boot();
  EXPECT_EQ(pass(10s), 0u);
  EXPECT_EQ(verdict(), CpuVerdict::alive);
  EXPECT_THAT(findings_, ElementsAre("alive: boot 1"));
}

TEST_F(WatchdogTest, ASilentCpuIsHungAndReset) {
  run_for_long();
  hang();
  EXPECT_EQ(pass(100ms), 1u);
  EXPECT_EQ(verdict(), CpuVerdict::hung);
  EXPECT_THAT(findings_, ElementsAre("hung: silent for 640 ms", "hung: reset 1 of 3 ordered"));
  EXPECT_EQ(knee().reset_reason, "silent for 640 ms");
  EXPECT_EQ(knee().hangs, 1u);
}

TEST_F(WatchdogTest, ASlowCpuThatItsControllerCallsRunningIsAlive) {
  run_for_long();
  set(State::running, 590ms);  // of three times 200 ms
  EXPECT_EQ(pass(60s), 0u);
  EXPECT_THAT(findings_, IsEmpty());
}

TEST_F(WatchdogTest, ACpuThatSpeaksAgainByItselfIsNoLongerHung) {
  watch(Policy::report);
  run_for_long();
  hang();
  pass(1s);
  speak();
  pass(100ms);
  EXPECT_THAT(findings_, ElementsAre("hung: silent for 640 ms", "alive: it speaks again by itself"));
  EXPECT_EQ(knee().confirmed, 0u);
}

TEST_F(WatchdogTest, HasAGraceForBooting) {
  set(State::booting, 0ms);
  EXPECT_EQ(pass(60s), 0u);  // a process that never attaches is for its own daemon to end
  boot();
  pass(100ms);
  hang();
  EXPECT_EQ(pass(1900ms), 0u);  // 2 s from the new boot number on
  EXPECT_EQ(verdict(), CpuVerdict::booting);
  EXPECT_EQ(pass(100ms), 1u);
  EXPECT_EQ(verdict(), CpuVerdict::hung);
}

TEST_F(WatchdogTest, AHigherBootNumberMeansThatTheResetWorked) {
  run_for_long();
  hang();
  pass(100ms);
  set(State::booting, 0ms);  // killed, and started again
  pass(500ms);
  EXPECT_EQ(verdict(), CpuVerdict::hung);
  EXPECT_EQ(knee().confirmed, 0u);
  boot();
  EXPECT_EQ(pass(100ms), 0u);
  EXPECT_EQ(verdict(), CpuVerdict::alive);
  EXPECT_EQ(knee().confirmed, 1u);
  EXPECT_EQ(findings_.back(), "alive: reset confirmed, boot 2");
  EXPECT_FALSE(watchdog_->reset_ended(kKnee, true, "the CPU has booted again", now_));
}

TEST_F(WatchdogTest, ALowerBootNumberMeansAnotherDaemonAndNotAReset) {
  run_for_long();
  boot();
  pass(60s);
  hang();
  pass(100ms);
  cpu_.boots = 1;
  speak();
  pass(100ms);
  EXPECT_EQ(findings_.back(), "alive: boot 1");
  EXPECT_EQ(knee().confirmed, 0u);
}

TEST_F(WatchdogTest, OnlyOneResetIsPendingAtATime) {
  run_for_long();
  hang();
  EXPECT_EQ(pass(60s), 1u);
}

TEST_F(WatchdogTest, TriesAgainWithDoublingBackOffAndGivesUp) {
  run_for_long();
  hang();
  EXPECT_EQ(pass(100ms), 1u);
  reset_fails();
  EXPECT_EQ(pass(900ms), 0u);
  EXPECT_EQ(pass(100ms), 1u);  // 1 s after the first failed
  reset_fails();
  EXPECT_EQ(pass(1900ms), 0u);
  EXPECT_EQ(pass(100ms), 1u);  // 2 s after the second
  EXPECT_FALSE(knee().given_up);
  reset_fails();
  EXPECT_TRUE(knee().given_up);
  EXPECT_EQ(findings_.back(), "hung: reset 3 of 3 failed, given up: no CPU has come back in time");
  EXPECT_EQ(pass(600s), 0u);
  EXPECT_EQ(knee().resets, 3u);
}

TEST_F(WatchdogTest, ACpuThatHangsAfterEveryResetIsGivenUpToo) {
  run_for_long();
  for (unsigned round = 1; round <= 3; ++round) {
    hang();
    EXPECT_EQ(pass(5s), 1u) << round;  // its grace is over after 2 s
    boot();
    pass(1s);  // too short to be forgiven
  }
  hang();
  EXPECT_EQ(pass(600s), 0u);
  EXPECT_TRUE(knee().given_up);
  EXPECT_EQ(findings_.back(), "hung: given up: it hangs after reset 3 of 3");
  EXPECT_EQ(knee().confirmed, 3u);
}

TEST_F(WatchdogTest, TriesAreForgottenOnceTheCpuHasRunForLong) {
  run_for_long();
  hang();
  pass(100ms);
  boot();
  pass(2900ms);
  EXPECT_EQ(knee().tries, 1u);
  pass(200ms);  // grace and back-off together: 3 s
  EXPECT_EQ(knee().tries, 0u);
  EXPECT_EQ(knee().resets, 1u);
}

TEST_F(WatchdogTest, ACpuThatWasGivenUpIsWatchedAgainOnceSomebodyElseResetsIt) {
  run_for_long();
  hang();
  for (int i = 0; i < 3; ++i) {
    pass(3s);
    reset_fails();
  }
  ASSERT_TRUE(knee().given_up);
  boot();
  pass(60s);
  EXPECT_FALSE(knee().given_up);
  hang();
  EXPECT_EQ(pass(100ms), 1u);
}

TEST_F(WatchdogTest, ADeadNodeIsNotAHungCpu) {
  run_for_long();
  beacons_ = false;
  EXPECT_EQ(pass(60s), 0u);
  EXPECT_EQ(verdict(), CpuVerdict::unreachable);
  EXPECT_THAT(findings_, ElementsAre("unreachable: no beacon of its node for 500 ms"));
}

TEST_F(WatchdogTest, AHungCpuWhoseNodeDiesIsNoLongerReset) {
  run_for_long();
  hang();
  pass(100ms);
  reset_fails();
  beacons_ = false;
  EXPECT_EQ(pass(600ms), 0u);
  EXPECT_EQ(pass(60s), 0u);
  EXPECT_EQ(verdict(), CpuVerdict::unreachable);
}

TEST_F(WatchdogTest, ASupervisorThatSleptCallsNobodyUnreachable) {
  run_for_long();
  now_ += 10s;  // nothing was read meanwhile
  evaluate();
  EXPECT_EQ(verdict(), CpuVerdict::alive);
  pass(1s);
  EXPECT_THAT(findings_, IsEmpty());
}

TEST_F(WatchdogTest, ANodeNeverHeardIsNeitherHungNorUnreachable) {
  beacons_ = false;
  EXPECT_EQ(pass(60s), 0u);
  EXPECT_EQ(verdict(), CpuVerdict::unheard);
}

TEST_F(WatchdogTest, ACpuThatIsNotThereIsAbsent) {
  run_for_long();
  set(State::failed, 0ms);
  EXPECT_EQ(pass(60s), 0u);
  EXPECT_THAT(findings_, ElementsAre("absent: failed"));
}

TEST_F(WatchdogTest, ACpuThatNobodyStartsAgainIsNotKilled) {
  run_for_long();
  cpu_.comes_back = false;
  hang();
  EXPECT_EQ(pass(60s), 0u);
  EXPECT_THAT(findings_, ElementsAre("hung: silent for 640 ms", "hung: not reset: nobody would start it again"));
}

TEST_F(WatchdogTest, PolicyReportOrdersNothing) {
  watch(Policy::report);
  run_for_long();
  hang();
  EXPECT_EQ(pass(60s), 0u);
  EXPECT_EQ(verdict(), CpuVerdict::hung);
  EXPECT_EQ(knee().resets, 0u);
  EXPECT_FALSE(knee().given_up);
}

TEST_F(WatchdogTest, UnderPolicyReportAResetByHandEndsTheHang) {
  watch(Policy::report);
  run_for_long();
  hang();
  pass(1s);
  boot();
  pass(100ms);
  EXPECT_EQ(findings_.back(), "alive: boot 2");
  EXPECT_EQ(knee().confirmed, 0u);
}

TEST_F(WatchdogTest, PolicyOffFindsNothing) {
  watch(Policy::off);
  run_for_long();
  hang();
  EXPECT_EQ(pass(60s), 0u);
  EXPECT_EQ(verdict(), CpuVerdict::unheard);
  EXPECT_THAT(findings_, IsEmpty());
}

}  // namespace
}  // namespace limb_ring::watchdog
