#include "io/process_state.h"

#include <gtest/gtest.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <string>

namespace limb_ring::process {
namespace {

pid_t start_child() {
  const pid_t child = ::fork();
  if (child == 0) {
    for (;;) ::pause();
  }
  return child;
}

void end(pid_t child) {
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

TEST(ProcessState, TellsAStoppedOneFromOneThatHasEnded) {
  const pid_t child = start_child();
  EXPECT_FALSE(is_gone(child));
  ::kill(child, SIGSTOP);
  ::waitpid(child, nullptr, WUNTRACED);
  EXPECT_TRUE(is_stopped(child));
  end(child);
  EXPECT_TRUE(is_gone(child));
}

TEST(ProcessState, OneThatADebuggerHoldsIsStopped) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::ptrace(PTRACE_TRACEME);
    ::raise(SIGSTOP);
    ::_exit(0);
  }
  ::waitpid(child, nullptr, WUNTRACED);
  EXPECT_EQ(process_state(child), 't');
  EXPECT_TRUE(is_stopped(child));
  end(child);
}

/// Whoever waits for the end of another's child reads its state just as that goes away.
TEST(ProcessState, OfAProcessThatEndsWhileItIsReadIsUnknown) {
  const pid_t child = start_child();
  std::ifstream stat("/proc/" + std::to_string(child) + "/stat");
  end(child);
  EXPECT_EQ(state_in(stat), '\0');
}

}  // namespace
}  // namespace limb_ring::process
