// The CPU as a child of the daemon: started, reset, restarted, given up.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>

#include "node/cpu_fixture.h"

namespace limb_ring::runtime {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

const std::vector<std::string> kSleeper{"sleep", "1000"};

TEST_F(CpuProcessTest, ChildIsBootingUntilItAttaches) {
  start(child(kSleeper));
  EXPECT_EQ(status().state, wire::CpuState::booting);
  EXPECT_EQ(status().boots, 0u);
  EXPECT_TRUE(cpu->attached(status().pid, kNobodyRestartsIt, 0ms));
  EXPECT_EQ(status().state, wire::CpuState::running);
  EXPECT_EQ(status().boots, 1u);
  EXPECT_EQ(status().kind, CpuKind::child);
}

TEST_F(CpuProcessTest, ChildThatGreetsAndLeavesDoesNotBoot) {
  CpuOptions options = child(kSleeper);
  options.boot_timeout = 1ms;
  start(options);
  cpu->greeted(status().pid);
  cpu->left(status().pid);
  EXPECT_TRUE(until([&] { return status().failed_boots == 1; }));
}

TEST_F(CpuProcessTest, ChangesAreToldFromTheEventLoopOnly) {
  start(child(kSleeper));
  cpu->attached(status().pid, kNobodyRestartsIt, 0ms);
  EXPECT_EQ(changes, 0);
  EXPECT_TRUE(until([&] { return changes == 1; }));
}

TEST_F(CpuProcessTest, ResetOfAStoppedChildGivesANewProcess) {
  start(child(kSleeper));
  const pid_t old = status().pid;
  cpu->attached(old, kNobodyRestartsIt, 0ms);
  ::kill(old, SIGSTOP);
  ASSERT_TRUE(until_stopped(old));

  const CpuActionResult report = cpu->reset("INTP from node 0");
  EXPECT_TRUE(report.done);
  EXPECT_TRUE(report.comes_back);
  ASSERT_TRUE(until_new_child(old));
  EXPECT_EQ(process_state(old), 0) << "the old child was not waited for";
  EXPECT_EQ(status().state, wire::CpuState::booting);
  EXPECT_EQ(status().boots, 1u) << "a boot counts when the new process attaches, not before";
  EXPECT_TRUE(cpu->attached(status().pid, kNobodyRestartsIt, 0ms));
  EXPECT_EQ(status().boots, 2u);
  EXPECT_EQ(status().resets, 1u);
  EXPECT_EQ(status().last_reset_reason, "INTP from node 0");
  EXPECT_EQ(status().exits, 0u) << "a reset is no exit by itself";
}

TEST_F(CpuProcessTest, ResetWorksTheSameWithoutPidfd) {
  CpuOptions options = child(kSleeper);
  options.by = process::ProcessHandle::By::number;
  start(options);
  const pid_t old = status().pid;
  ::kill(old, SIGSTOP);
  ASSERT_TRUE(until_stopped(old));
  EXPECT_TRUE(cpu->reset("test").done);
  EXPECT_TRUE(until_new_child(old));
}

TEST_F(CpuProcessTest, ChildThatEndedBeforeItWasWatchedIsSeenWithoutPidfd) {
  CpuOptions options = child({"true"});
  options.by = process::ProcessHandle::By::number;
  start(options);
  EXPECT_TRUE(until([&] { return status().exits >= 3; }));
}

TEST_F(CpuProcessTest, ResetEndsTheWholeGroupOfTheChild) {
  start(child({"sh", "-c", "sleep 1000 & echo $! >&2; wait"}));
  const pid_t shell = status().pid;
  const std::string children = "/proc/" + std::to_string(shell) + "/task/" + std::to_string(shell) + "/children";
  pid_t grandchild = 0;
  ASSERT_TRUE(until([&] { return bool(std::ifstream(children) >> grandchild); }));
  const process::ProcessHandle handle(grandchild);
  cpu->reset("test");
  EXPECT_TRUE(until([&] { return handle.ended() || process_state(grandchild) == 'Z'; }));
}

TEST_F(CpuProcessTest, ProcessBeingResetCannotAttachAnyMore) {
  start(child(kSleeper));
  const pid_t old = status().pid;
  cpu->reset("test");
  EXPECT_FALSE(cpu->attached(old, kNobodyRestartsIt, 0ms));
  EXPECT_EQ(status().boots, 0u);
}

TEST_F(CpuProcessTest, ChildThatEndsIsStartedAgain) {
  start(child({"sh", "-c", "exit 3"}));
  ASSERT_TRUE(until([&] { return status().exits >= 2; }));
  EXPECT_EQ(status().last_exit, "exit 3");
  EXPECT_TRUE(until([&] { return status().exits >= 5; }));
}

TEST_F(CpuProcessTest, BadEndShowsAsFailedWithItsSignal) {
  CpuOptions options = child({"sh", "-c", "kill -9 $$"});
  options.cpu.restart_on_exit = false;
  start(options);
  ASSERT_TRUE(until([&] { return status().exits == 1; }));
  EXPECT_EQ(status().last_exit, "signal 9 (Killed)");
  EXPECT_EQ(status().state, wire::CpuState::failed);
  EXPECT_EQ(status().pid, -1);
}

TEST_F(CpuProcessTest, ChildNotToBeRestartedStaysAwayUntilReset) {
  CpuOptions options = child({"true"});
  options.cpu.restart_on_exit = false;
  start(options);
  ASSERT_TRUE(until([&] { return status().exits == 1; }));
  EXPECT_EQ(status().state, wire::CpuState::absent);
  EXPECT_TRUE(cpu->reset("test").comes_back);
  EXPECT_TRUE(until([&] { return status().exits == 2; }));
}

TEST_F(CpuProcessTest, ProgramThatIsNotThereFailsWithItsName) {
  start(child({"no_such_firmware"}));
  EXPECT_EQ(status().state, wire::CpuState::failed);
  EXPECT_THAT(status().last_exit, HasSubstr("'no_such_firmware'"));
  EXPECT_TRUE(until([&] { return status().failed_boots >= 3; })) << "tried again with back-off";
  const CpuActionResult report = cpu->reset("test");
  EXPECT_FALSE(report.done);
  EXPECT_THAT(report.message, HasSubstr("'no_such_firmware'"));
}

TEST_F(CpuProcessTest, WaitBeforeEachNewStartDoubles) {
  for (const char* program : {"no_such_firmware", "false"}) {
    start(child({program}));
    EXPECT_TRUE(until([&] { return status().restart_wait == 8ms; })) << program;
    EXPECT_GE(status().failed_boots + status().exits, 4u) << "after 1, 2 and 4 ms";
  }
}

TEST_F(CpuProcessTest, ProgramThatCannotBeExecutedFailsWithTheReason) {
  std::string path = ::testing::TempDir() + "limb_ring_XXXXXX";
  process::UniqueFd file(::mkstemp(path.data()));
  ASSERT_TRUE(file.valid());
  ASSERT_EQ(::write(file.get(),
                    "\x7f"
                    "ELF",
                    4),
            4);
  ASSERT_EQ(::fchmod(file.get(), 0700), 0);
  file.reset();
  start(child({path}));
  EXPECT_TRUE(until([&] { return status().state == wire::CpuState::failed; }));
  EXPECT_THAT(status().last_exit, HasSubstr("cannot execute " + path));
  EXPECT_THAT(status().last_exit, EndsWith("Exec format error"));
  EXPECT_TRUE(until([&] { return status().failed_boots >= 2; }));
  ::unlink(path.c_str());
}

TEST_F(CpuProcessTest, ChildThatNeverAttachesIsKilledAndStartedAgain) {
  CpuOptions options = child(kSleeper);
  options.boot_timeout = 20ms;
  start(options);
  const pid_t old = status().pid;
  ASSERT_TRUE(until([&] { return status().failed_boots == 1; }));
  EXPECT_THAT(status().last_exit, HasSubstr("within 20 ms"));
  EXPECT_TRUE(until_new_child(old));
  EXPECT_EQ(status().boots, 0u);
}

TEST_F(CpuProcessTest, ChildThatLetsGoOfTheHostPortMustAttachAgain) {
  CpuOptions options = child(kSleeper);
  options.boot_timeout = 20ms;
  start(options);
  const pid_t old = status().pid;
  ASSERT_TRUE(cpu->attached(old, kNobodyRestartsIt, 0ms));
  cpu->detached(old);
  EXPECT_EQ(status().state, wire::CpuState::booting);
  EXPECT_TRUE(until_new_child(old));
}

TEST_F(CpuProcessTest, StopLetsTheChildEndByItself) {
  start(child(kSleeper));
  const process::ProcessHandle process(status().pid);
  ::kill(process.pid(), SIGSTOP);
  ASSERT_TRUE(until_stopped(process.pid()));
  bool stopped = false;
  cpu->stop([&] { stopped = true; });
  EXPECT_TRUE(until([&] { return stopped; }));
  EXPECT_TRUE(process.ended());
  EXPECT_EQ(status().state, wire::CpuState::absent);
  EXPECT_FALSE(cpu->reset("too late").done);
}

TEST_F(CpuProcessTest, StopKillsAChildThatDoesNotListen) {
  CpuOptions options = child({"sh", "-c", "trap '' TERM; kill -STOP $$; while :; do sleep 1000; done"});
  options.stop_timeout = 20ms;
  start(options);
  const process::ProcessHandle process(status().pid);
  ASSERT_TRUE(until_stopped(process.pid())) << "only then is the trap in place";
  bool stopped = false;
  cpu->stop([&] { stopped = true; });
  EXPECT_TRUE(until([&] { return stopped; }));
  EXPECT_TRUE(until([&] { return process.ended(); }));
}

TEST_F(CpuProcessTest, SignalReachesTheChild) {
  start(child(kSleeper));
  const pid_t pid = status().pid;
  EXPECT_TRUE(cpu->signal(SIGSTOP).done);
  EXPECT_TRUE(until_stopped(pid));
}

TEST_F(CpuProcessTest, ChildFindsItsRingInItsEnvironment) {
  CpuOptions options = child({"sh", "-c", "test $LIMB_RING_NODE = 12 && test -n \"$PATH\""});
  options.environment = {{"LIMB_RING_NODE", "12"}};
  options.cpu.restart_on_exit = false;
  start(options);
  ASSERT_TRUE(until([&] { return status().exits == 1; }));
  EXPECT_EQ(status().last_exit, "exit 0");
}

}  // namespace
}  // namespace limb_ring::runtime
