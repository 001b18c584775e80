// The CPU as an outside process on the host port, and the commands of exec pins.
#include <gmock/gmock.h>

#include <thread>

#include "runtime/supervisor_fixture.h"

namespace limb_ring::runtime {
namespace {

using ::testing::HasSubstr;

CpuOptions outside() {
  CpuOptions options;
  options.cpu.kind = config::CpuConfig::Kind::attached;
  return options;
}

TEST_F(SupervisorTest, AttachedCpuIsAbsentUntilItConnects) {
  const Outsider process;
  supervise(outside());
  EXPECT_EQ(status().state, CpuState::absent);
  EXPECT_TRUE(supervisor->attached(process.pid(), true, 0ms));
  EXPECT_EQ(status().state, CpuState::running);
  EXPECT_EQ(status().pid, process.pid());
  supervisor->detached(process.pid());
  EXPECT_EQ(status().state, CpuState::absent);
  EXPECT_EQ(status().boots, 1u);
}

TEST_F(SupervisorTest, ResetKillsTheAttachedProcessThoughStopped) {
  Outsider process;
  supervise(outside());
  supervisor->attached(process.pid(), true, 0ms);
  ::kill(process.pid(), SIGSTOP);
  ASSERT_TRUE(until_stopped(process.pid()));
  const CpuReport report = supervisor->reset("test");
  EXPECT_TRUE(report.done);
  EXPECT_TRUE(report.comes_back);
  const int wait_status = process.reap();
  EXPECT_TRUE(WIFSIGNALED(wait_status) && WTERMSIG(wait_status) == SIGKILL);
  EXPECT_EQ(status().state, CpuState::absent);
}

TEST_F(SupervisorTest, ResetSaysWhereNobodyRestartsTheAttachedProcess) {
  const Outsider process;
  supervise(outside());
  supervisor->attached(process.pid(), false, 0ms);
  const CpuReport report = supervisor->reset("test");
  EXPECT_TRUE(report.done);
  EXPECT_FALSE(report.comes_back);
  EXPECT_THAT(report.message, HasSubstr("nobody starts it again"));
}

TEST_F(SupervisorTest, ResetOfNobodySaysSo) {
  supervise(outside());
  const CpuReport report = supervisor->reset("test");
  EXPECT_FALSE(report.done);
  EXPECT_THAT(report.message, HasSubstr("no CPU is attached"));
  EXPECT_EQ(status().resets, 0u);
}

TEST_F(SupervisorTest, KilledProcessCannotAttachAgainButItsSuccessorCan) {
  Outsider process;
  const Outsider successor;
  supervise(outside());
  supervisor->attached(process.pid(), true, 0ms);
  supervisor->reset("test");
  EXPECT_FALSE(supervisor->attached(process.pid(), true, 0ms));
  EXPECT_TRUE(supervisor->attached(successor.pid(), true, 0ms));
  EXPECT_EQ(status().boots, 2u);
}

TEST_F(SupervisorTest, EndOfTheFormerCpuLeavesItsSuccessorAlone) {
  const Outsider former, successor;
  supervise(outside());
  supervisor->attached(former.pid(), true, 0ms);
  supervisor->attached(successor.pid(), true, 0ms);
  supervisor->detached(former.pid());
  EXPECT_EQ(status().state, CpuState::running);
  EXPECT_EQ(status().pid, successor.pid());
}

TEST_F(SupervisorTest, ProcessThatIsGoneCannotAttach) {
  Outsider process;
  const pid_t pid = process.pid();
  process.end();
  supervise(outside());
  EXPECT_FALSE(supervisor->attached(pid, true, 0ms));
  EXPECT_EQ(status().boots, 0u);
}

TEST_F(SupervisorTest, HandleNeverSignalsAProcessThatHasEnded) {
  Outsider process;
  const ProcessHandle handle(process.pid());
  EXPECT_FALSE(handle.ended());
  process.end();
  EXPECT_TRUE(handle.ended());
  EXPECT_FALSE(handle.signal(SIGKILL));
}

TEST_F(SupervisorTest, CpuThatBreaksItsPromiseIsSilentUntilItSpeaks) {
  const Outsider process;
  supervise(outside());
  supervisor->attached(process.pid(), true, 10ms);
  ASSERT_TRUE(until([&] { return status().state == CpuState::silent; }));
  EXPECT_GE(status().silent, 30ms);
  supervisor->spoke(std::chrono::steady_clock::now());
  EXPECT_EQ(status().state, CpuState::running);
  EXPECT_TRUE(until([&] { return status().state == CpuState::silent; }));
}

TEST_F(SupervisorTest, DaemonThatSleptDoesNotBlameTheCpu) {
  const Outsider process;
  supervise(outside());
  supervisor->attached(process.pid(), true, 40ms);
  std::this_thread::sleep_for(200ms);  // the daemon's own sleep: 80 ms longer than three periods
  io.poll();
  EXPECT_EQ(status().state, CpuState::running);
  EXPECT_TRUE(until([&] { return status().state == CpuState::silent; }));
}

TEST(AttachedCpu, WithoutAPromiseIsNeverSilent) {
  const AttachedCpu::Time start{};
  const AttachedCpu cpu(ProcessHandle{}, false, 0ms, start);
  EXPECT_FALSE(cpu.silent(start + 1h));
}

TEST(AttachedCpu, IsSilentAfterThreePeriods) {
  const AttachedCpu::Time start{};
  const AttachedCpu cpu(ProcessHandle{}, false, 10ms, start);
  EXPECT_FALSE(cpu.silent(start + 29ms));
  EXPECT_TRUE(cpu.silent(start + 30ms));
}

TEST_F(SupervisorTest, NodeWithoutCpuHasNothingToReset) {
  supervise(CpuOptions{});
  EXPECT_EQ(status().state, CpuState::none);
  EXPECT_FALSE(supervisor->reset("test").done);
  EXPECT_FALSE(supervisor->signal(SIGUSR1).done);
}

TEST_F(SupervisorTest, StopWithoutChildEndsAtOnce) {
  supervise(CpuOptions{});
  bool stopped = false;
  supervisor->stop([&] { stopped = true; });
  EXPECT_FALSE(stopped) << "told from the event loop, not from inside the call";
  EXPECT_TRUE(until([&] { return stopped; }));
}

TEST_F(SupervisorTest, AtMostFourCommandsOfPinsRunAtATime) {
  supervise(CpuOptions{});
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(supervisor->run({"sleep", "1000"}).done);
  const CpuReport fifth = supervisor->run({"sleep", "1000"});
  EXPECT_FALSE(fifth.done);
  EXPECT_THAT(fifth.message, HasSubstr("4 commands"));
  EXPECT_EQ(supervisor->command_counters().refused, 1u);
}

TEST_F(SupervisorTest, CommandOfAPinIsKilledAtItsDeadline) {
  CpuOptions options;
  options.command_timeout = 20ms;
  supervise(options);
  ASSERT_TRUE(supervisor->run({"sleep", "1000"}).done);
  EXPECT_TRUE(until([&] { return supervisor->command_counters().failed == 1; }));
  EXPECT_EQ(supervisor->command_counters().timed_out, 1u);
}

TEST_F(SupervisorTest, PlaceOfACommandThatEndedIsFreeAgain) {
  supervise(CpuOptions{});
  for (unsigned i = 1; i <= 8; ++i) {
    ASSERT_TRUE(supervisor->run({"false"}).done);
    ASSERT_TRUE(until([&] { return supervisor->command_counters().failed == i; }));
  }
  EXPECT_EQ(supervisor->command_counters().timed_out, 0u);
}

TEST_F(SupervisorTest, UnknownCommandOfAPinIsRefusedByName) {
  supervise(CpuOptions{});
  const CpuReport report = supervisor->run({"no_such_command"});
  EXPECT_FALSE(report.done);
  EXPECT_THAT(report.message, HasSubstr("'no_such_command'"));
}

}  // namespace
}  // namespace limb_ring::runtime
