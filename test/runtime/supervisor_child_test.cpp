// The CPU as a child of the daemon: started, reset, restarted, given up.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "runtime/supervisor_fixture.h"

namespace limb_ring::runtime {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

const std::vector<std::string> kSleeper{"sleep", "1000"};

TEST_F(SupervisorTest, ChildIsBootingUntilItAttaches) {
  supervise(child(kSleeper));
  EXPECT_EQ(status().state, CpuState::booting);
  EXPECT_EQ(status().boots, 0u);
  EXPECT_TRUE(supervisor->attached(status().pid, false, 0ms));
  EXPECT_EQ(status().state, CpuState::running);
  EXPECT_EQ(status().boots, 1u);
  EXPECT_EQ(status().kind, CpuKind::child);
}

TEST_F(SupervisorTest, ChangesAreToldFromTheEventLoopOnly) {
  supervise(child(kSleeper));
  supervisor->attached(status().pid, false, 0ms);
  EXPECT_EQ(changes, 0);
  EXPECT_TRUE(until([&] { return changes == 1; }));
}

TEST_F(SupervisorTest, ResetOfAStoppedChildGivesANewProcess) {
  supervise(child(kSleeper));
  const pid_t old = status().pid;
  supervisor->attached(old, false, 0ms);
  ::kill(old, SIGSTOP);
  ASSERT_TRUE(until_stopped(old));

  const CpuReport report = supervisor->reset("INTP from node 0");
  EXPECT_TRUE(report.done);
  EXPECT_TRUE(report.comes_back);
  ASSERT_TRUE(until_new_child(old));
  EXPECT_EQ(process_state(old), ' ') << "the old child was not waited for";
  EXPECT_EQ(status().state, CpuState::booting);
  EXPECT_EQ(status().boots, 1u) << "a boot counts when the new process attaches, not before";
  EXPECT_TRUE(supervisor->attached(status().pid, false, 0ms));
  EXPECT_EQ(status().boots, 2u);
  EXPECT_EQ(status().resets, 1u);
  EXPECT_EQ(status().last_reset_reason, "INTP from node 0");
  EXPECT_EQ(status().exits, 0u) << "a reset is no exit by itself";
}

TEST_F(SupervisorTest, ResetWorksTheSameWithoutPidfd) {
  CpuOptions options = child(kSleeper);
  options.by = ProcessHandle::By::number;
  supervise(options);
  const pid_t old = status().pid;
  ::kill(old, SIGSTOP);
  ASSERT_TRUE(until_stopped(old));
  EXPECT_TRUE(supervisor->reset("test").done);
  EXPECT_TRUE(until_new_child(old));
}

TEST_F(SupervisorTest, ChildThatEndedBeforeItWasWatchedIsSeenWithoutPidfd) {
  CpuOptions options = child({"true"});
  options.by = ProcessHandle::By::number;
  supervise(options);
  EXPECT_TRUE(until([&] { return status().exits >= 3; }));
}

TEST_F(SupervisorTest, ResetEndsTheWholeGroupOfTheChild) {
  supervise(child({"sh", "-c", "sleep 1000 & echo $! >&2; wait"}));
  const pid_t shell = status().pid;
  const std::string children =
      "/proc/" + std::to_string(shell) + "/task/" + std::to_string(shell) + "/children";
  pid_t grandchild = 0;
  ASSERT_TRUE(until([&] { return bool(std::ifstream(children) >> grandchild); }));
  const ProcessHandle handle(grandchild);
  supervisor->reset("test");
  EXPECT_TRUE(until([&] { return handle.ended() || process_state(grandchild) == 'Z'; }));
}

TEST_F(SupervisorTest, ProcessBeingResetCannotAttachAnyMore) {
  supervise(child(kSleeper));
  const pid_t old = status().pid;
  supervisor->reset("test");
  EXPECT_FALSE(supervisor->attached(old, false, 0ms));
  EXPECT_EQ(status().boots, 0u);
}

TEST_F(SupervisorTest, ChildThatEndsIsStartedAgain) {
  supervise(child({"sh", "-c", "exit 3"}));
  ASSERT_TRUE(until([&] { return status().exits >= 2; }));
  EXPECT_EQ(status().last_exit, "exit 3");
  EXPECT_TRUE(until([&] { return status().exits >= 5; }));
}

TEST_F(SupervisorTest, BadEndShowsAsFailedWithItsSignal) {
  CpuOptions options = child({"sh", "-c", "kill -9 $$"});
  options.cpu.restart_on_exit = false;
  supervise(options);
  ASSERT_TRUE(until([&] { return status().exits == 1; }));
  EXPECT_EQ(status().last_exit, "signal 9 (Killed)");
  EXPECT_EQ(status().state, CpuState::failed);
  EXPECT_EQ(status().pid, -1);
}

TEST_F(SupervisorTest, ChildNotToBeRestartedStaysAwayUntilReset) {
  CpuOptions options = child({"true"});
  options.cpu.restart_on_exit = false;
  supervise(options);
  ASSERT_TRUE(until([&] { return status().exits == 1; }));
  EXPECT_EQ(status().state, CpuState::absent);
  EXPECT_TRUE(supervisor->reset("test").comes_back);
  EXPECT_TRUE(until([&] { return status().exits == 2; }));
}

TEST_F(SupervisorTest, ProgramThatIsNotThereFailsWithItsName) {
  supervise(child({"no_such_firmware"}));
  EXPECT_EQ(status().state, CpuState::failed);
  EXPECT_THAT(status().last_exit, HasSubstr("'no_such_firmware'"));
  EXPECT_TRUE(until([&] { return status().failed_boots >= 3; })) << "tried again with back-off";
  const CpuReport report = supervisor->reset("test");
  EXPECT_FALSE(report.done);
  EXPECT_THAT(report.message, HasSubstr("'no_such_firmware'"));
}

TEST_F(SupervisorTest, WaitBeforeEachNewStartDoubles) {
  for (const char* program : {"no_such_firmware", "false"}) {
    supervise(child({program}));
    EXPECT_TRUE(until([&] { return status().restart_wait == 8ms; })) << program;
    EXPECT_GE(status().failed_boots + status().exits, 4u) << "after 1, 2 and 4 ms";
  }
}

TEST_F(SupervisorTest, ProgramThatCannotBeExecutedFailsWithTheReason) {
  std::string path = ::testing::TempDir() + "limb_ring_XXXXXX";
  UniqueFd file(::mkstemp(path.data()));
  ASSERT_TRUE(file.valid());
  ASSERT_EQ(::write(file.get(), "\x7f" "ELF", 4), 4);
  ASSERT_EQ(::fchmod(file.get(), 0700), 0);
  file.reset();
  supervise(child({path}));
  EXPECT_TRUE(until([&] { return status().state == CpuState::failed; }));
  EXPECT_THAT(status().last_exit, HasSubstr("cannot execute " + path));
  EXPECT_THAT(status().last_exit, EndsWith("Exec format error"));
  EXPECT_TRUE(until([&] { return status().failed_boots >= 2; }));
  ::unlink(path.c_str());
}

TEST_F(SupervisorTest, ChildThatNeverAttachesIsKilledAndStartedAgain) {
  CpuOptions options = child(kSleeper);
  options.boot_timeout = 20ms;
  supervise(options);
  const pid_t old = status().pid;
  ASSERT_TRUE(until([&] { return status().failed_boots == 1; }));
  EXPECT_THAT(status().last_exit, HasSubstr("within 20 ms"));
  EXPECT_TRUE(until_new_child(old));
  EXPECT_EQ(status().boots, 0u);
}

TEST_F(SupervisorTest, ChildThatLetsGoOfTheHostPortMustAttachAgain) {
  CpuOptions options = child(kSleeper);
  options.boot_timeout = 20ms;
  supervise(options);
  const pid_t old = status().pid;
  ASSERT_TRUE(supervisor->attached(old, false, 0ms));
  supervisor->detached(old);
  EXPECT_EQ(status().state, CpuState::booting);
  EXPECT_TRUE(until_new_child(old));
}

TEST_F(SupervisorTest, StopLetsTheChildEndByItself) {
  supervise(child(kSleeper));
  const ProcessHandle process(status().pid);
  ::kill(process.pid(), SIGSTOP);
  ASSERT_TRUE(until_stopped(process.pid()));
  bool stopped = false;
  supervisor->stop([&] { stopped = true; });
  EXPECT_TRUE(until([&] { return stopped; }));
  EXPECT_TRUE(process.ended());
  EXPECT_EQ(status().state, CpuState::absent);
  EXPECT_FALSE(supervisor->reset("too late").done);
}

TEST_F(SupervisorTest, StopKillsAChildThatDoesNotListen) {
  CpuOptions options = child({"sh", "-c", "trap '' TERM; kill -STOP $$; while :; do sleep 1000; done"});
  options.stop_timeout = 20ms;
  supervise(options);
  const ProcessHandle process(status().pid);
  ASSERT_TRUE(until_stopped(process.pid())) << "only then is the trap in place";
  bool stopped = false;
  supervisor->stop([&] { stopped = true; });
  EXPECT_TRUE(until([&] { return stopped; }));
  EXPECT_TRUE(until([&] { return process.ended(); }));
}

TEST_F(SupervisorTest, SignalReachesTheChild) {
  supervise(child(kSleeper));
  const pid_t pid = status().pid;
  EXPECT_TRUE(supervisor->signal(SIGSTOP).done);
  EXPECT_TRUE(until_stopped(pid));
}

TEST_F(SupervisorTest, ChildFindsItsRingInItsEnvironment) {
  CpuOptions options = child({"sh", "-c", "test $LIMB_RING_NODE = 12 && test -n \"$PATH\""});
  options.environment = {{"LIMB_RING_NODE", "12"}};
  options.cpu.restart_on_exit = false;
  supervise(options);
  ASSERT_TRUE(until([&] { return status().exits == 1; }));
  EXPECT_EQ(status().last_exit, "exit 0");
}

}  // namespace
}  // namespace limb_ring::runtime
