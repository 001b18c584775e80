// The CPU as an outside process on the host port, and the commands of exec pins.
#include <gmock/gmock.h>

#include "node/cpu_fixture.h"

namespace limb_ring::runtime {
namespace {

using ::testing::HasSubstr;

CpuOptions outside() {
  CpuOptions options;
  options.cpu.kind = config::CpuConfig::Kind::attached;
  return options;
}

TEST_F(CpuProcessTest, AttachedCpuIsAbsentUntilItConnects) {
  const Outsider process;
  start(outside());
  EXPECT_EQ(status().state, wire::CpuState::absent);
  EXPECT_TRUE(cpu->attached(process.pid(), kOwnerRestartsIt, 0ms));
  EXPECT_EQ(status().state, wire::CpuState::running);
  EXPECT_EQ(status().pid, process.pid());
  cpu->detached(process.pid());
  EXPECT_EQ(status().state, wire::CpuState::absent);
  EXPECT_EQ(status().boots, 1u);
}

TEST_F(CpuProcessTest, ResetKillsTheAttachedProcessThoughStopped) {
  Outsider process;
  start(outside());
  cpu->attached(process.pid(), kOwnerRestartsIt, 0ms);
  ::kill(process.pid(), SIGSTOP);
  ASSERT_TRUE(until_stopped(process.pid()));
  const CpuActionResult report = cpu->reset("test");
  EXPECT_TRUE(report.done);
  EXPECT_TRUE(report.comes_back);
  const int wait_status = process.reap();
  EXPECT_TRUE(WIFSIGNALED(wait_status) && WTERMSIG(wait_status) == SIGKILL);
  EXPECT_EQ(status().state, wire::CpuState::absent);
}

TEST_F(CpuProcessTest, ResetSaysIfNobodyRestartsTheAttachedProcess) {
  const Outsider process;
  start(outside());
  cpu->attached(process.pid(), kNobodyRestartsIt, 0ms);
  const CpuActionResult report = cpu->reset("test");
  EXPECT_TRUE(report.done);
  EXPECT_FALSE(report.comes_back);
  EXPECT_THAT(report.message, HasSubstr("nobody starts it again"));
}

TEST_F(CpuProcessTest, ResetOfNobodySaysSo) {
  start(outside());
  const CpuActionResult report = cpu->reset("test");
  EXPECT_FALSE(report.done);
  EXPECT_THAT(report.message, HasSubstr("no CPU is attached"));
  EXPECT_EQ(status().resets, 0u);
}

TEST_F(CpuProcessTest, KilledProcessCannotAttachAgainButItsSuccessorCan) {
  Outsider process;
  const Outsider successor;
  start(outside());
  cpu->attached(process.pid(), kOwnerRestartsIt, 0ms);
  cpu->reset("test");
  EXPECT_FALSE(cpu->attached(process.pid(), kOwnerRestartsIt, 0ms));
  EXPECT_TRUE(cpu->attached(successor.pid(), kOwnerRestartsIt, 0ms));
  EXPECT_EQ(status().boots, 2u);
}

TEST_F(CpuProcessTest, EndOfTheFormerCpuLeavesItsSuccessorAlone) {
  const Outsider former, successor;
  start(outside());
  cpu->attached(former.pid(), kOwnerRestartsIt, 0ms);
  cpu->attached(successor.pid(), kOwnerRestartsIt, 0ms);
  cpu->detached(former.pid());
  EXPECT_EQ(status().state, wire::CpuState::running);
  EXPECT_EQ(status().pid, successor.pid());
}

TEST_F(CpuProcessTest, ProcessThatIsGoneCannotAttach) {
  Outsider process;
  const pid_t pid = process.pid();
  process.end();
  start(outside());
  EXPECT_FALSE(cpu->attached(pid, kOwnerRestartsIt, 0ms));
  EXPECT_EQ(status().boots, 0u);
}

TEST_F(CpuProcessTest, HandleNeverSignalsAProcessThatHasEnded) {
  Outsider process;
  const process::ProcessHandle handle(process.pid());
  EXPECT_FALSE(handle.ended());
  process.end();
  EXPECT_TRUE(handle.ended());
  EXPECT_FALSE(handle.signal(SIGKILL));
}

TEST_F(CpuProcessTest, CpuThatBreaksItsPromiseIsSilentUntilItSpeaks) {
  const Outsider process;
  start(outside());
  cpu->attached(process.pid(), kOwnerRestartsIt, 10ms);
  ASSERT_TRUE(until([&] { return status().state == wire::CpuState::silent; }));
  EXPECT_GE(status().silent, 30ms);
  cpu->spoke(std::chrono::steady_clock::now());
  EXPECT_EQ(status().state, wire::CpuState::running);
  EXPECT_TRUE(until([&] { return status().state == wire::CpuState::silent; }));
}

TEST_F(CpuProcessTest, NodeWithoutCpuHasNothingToReset) {
  start(CpuOptions{});
  EXPECT_EQ(status().state, wire::CpuState::none);
  EXPECT_FALSE(cpu->reset("test").done);
  EXPECT_FALSE(cpu->signal(SIGUSR1).done);
}

TEST_F(CpuProcessTest, StopWithoutChildEndsAtOnce) {
  start(CpuOptions{});
  bool stopped = false;
  cpu->stop([&] { stopped = true; });
  EXPECT_FALSE(stopped) << "told from the event loop, not from inside the call";
  EXPECT_TRUE(until([&] { return stopped; }));
}

TEST_F(CpuProcessTest, AtMostFourCommandsOfPinsRunAtATime) {
  start(CpuOptions{});
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(cpu->run({"sleep", "1000"}).done);
  const CpuActionResult fifth = cpu->run({"sleep", "1000"});
  EXPECT_FALSE(fifth.done);
  EXPECT_THAT(fifth.message, HasSubstr("4 commands"));
  EXPECT_EQ(cpu->command_counters().refused, 1u);
}

TEST_F(CpuProcessTest, CommandOfAPinIsKilledAtItsDeadline) {
  CpuOptions options;
  options.command_timeout = 20ms;
  start(options);
  ASSERT_TRUE(cpu->run({"sleep", "1000"}).done);
  EXPECT_TRUE(until([&] { return cpu->command_counters().failed == 1; }));
  EXPECT_EQ(cpu->command_counters().timed_out, 1u);
}

TEST_F(CpuProcessTest, PlaceOfACommandThatEndedIsFreeAgain) {
  start(CpuOptions{});
  for (unsigned i = 1; i <= 8; ++i) {
    ASSERT_TRUE(cpu->run({"false"}).done);
    ASSERT_TRUE(until([&] { return cpu->command_counters().failed == i; }));
  }
  EXPECT_EQ(cpu->command_counters().timed_out, 0u);
}

TEST_F(CpuProcessTest, UnknownCommandOfAPinIsRefusedByName) {
  start(CpuOptions{});
  const CpuActionResult report = cpu->run({"no_such_command"});
  EXPECT_FALSE(report.done);
  EXPECT_THAT(report.message, HasSubstr("'no_such_command'"));
}

}  // namespace
}  // namespace limb_ring::runtime
