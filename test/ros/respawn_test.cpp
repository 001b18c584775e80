#include "ros_bridge/node_main.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

namespace limb_ring::bridge {
namespace {

struct Pipe {
  Pipe() { EXPECT_EQ(pipe(ends), 0); }
  int ends[2];
};

/// Ends as soon as all writing ends of that pipe are closed.
int until_closed(const Pipe& open) {
  char byte = 0;
  return static_cast<int>(read(open.ends[0], &byte, 1));
}

/// A program in a process that restarts it, and whoever has started that. It says the pid of what restarts it.
class Respawned : public ::testing::Test {
 protected:
  Respawned() : starter(fork()) {
    if (starter != 0) {
      close(said.ends[1]);
      return;
    }
    close(may_run.ends[1]);
    if (fork() == 0) _exit(respawned([this] { return run(); }));
    for (;;) pause();
  }
  int run() const {
    const pid_t restarts_it = getppid();
    return write(said.ends[1], &restarts_it, sizeof restarts_it) > 0 ? until_closed(may_run) : 1;
  }
  /// The next start of the program: the pid of what restarts it; 0 if that is gone.
  pid_t next_start() const {
    pid_t pid = 0;
    return read(said.ends[0], &pid, sizeof pid) == sizeof pid ? pid : 0;
  }
  void end_starter() const {
    kill(starter, SIGKILL);
    waitpid(starter, nullptr, 0);
  }

  Pipe said, may_run;
  const pid_t starter;
};

TEST_F(Respawned, IsStartedAgainWhenItEnds) {
  const pid_t pid = next_start();
  close(may_run.ends[1]);
  EXPECT_EQ(next_start(), pid);
  kill(pid, SIGTERM);
  end_starter();
}

TEST_F(Respawned, IsNotStartedAgainOnceItsStarterIsGone) {
  const pid_t pid = next_start();
  end_starter();
  close(may_run.ends[1]);
  EXPECT_EQ(next_start(), 0);
  kill(pid, SIGTERM);
}

}  // namespace
}  // namespace limb_ring::bridge
