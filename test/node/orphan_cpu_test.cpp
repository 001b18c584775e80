// Children die with the daemon, however it ends.
#include <sys/prctl.h>

#include <fstream>

#include "node/cpu_fixture.h"

namespace limb_ring::runtime {
namespace {

struct NoEvents final : CpuEvents {
  void on_cpu_changed() override {}
};

/// What a daemon does: starts its CPU, tells its number, and runs.
[[noreturn]] void be_a_daemon(int pipe) {
  boost::asio::io_context io;
  NoEvents events;
  CpuOptions options;
  options.cpu.kind = config::CpuConfig::Kind::child;
  options.cpu.command = {"sleep", "1000"};
  event_loop::MachineClock clock(io);
  CpuProcess cpu(io, clock, options, events);
  cpu.start();
  const pid_t pid = cpu.status().pid;
  if (::write(pipe, &pid, sizeof pid) != sizeof pid) ::_exit(1);
  io.run_for(test::kGuard);
  ::_exit(0);
}

class OrphanTest : public ::testing::Test {
 protected:
  OrphanTest() {
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // so that the orphan's end can be waited for here
    int ends[2];
    if (::pipe(ends) != 0) return;
    daemon = ::fork();
    if (daemon == 0) be_a_daemon(ends[1]);
    process::UniqueFd read_end(ends[0]), write_end(ends[1]);
    if (::read(read_end.get(), &cpu, sizeof cpu) != sizeof cpu) cpu = -1;
  }
  ~OrphanTest() override { ::prctl(PR_SET_CHILD_SUBREAPER, 0); }

  static bool until(const std::function<bool()>& condition) {
    boost::asio::io_context io;
    return run_until(io, condition);
  }
  /// -1 if it does not end.
  static int wait_status_of(pid_t pid) {
    int status = -1;
    until([&] { return ::waitpid(pid, &status, WNOHANG) == pid; });
    return status;
  }
  /// Its own program runs by now, no longer the copy of its parent that fork made.
  bool cpu_has_booted() const {
    std::ifstream file("/proc/" + std::to_string(cpu) + "/comm");
    std::string name;
    return file >> name && name == "sleep";
  }

  pid_t daemon = -1;
  pid_t cpu = -1;
};

TEST_F(OrphanTest, StoppedChildEndsWhenTheDaemonIsKilled) {
  ASSERT_GT(cpu, 0);
  ASSERT_TRUE(until([&] { return cpu_has_booted(); }));
  ::kill(cpu, SIGSTOP);
  ASSERT_TRUE(until([&] { return process_state(cpu) == 'T'; }));
  ::kill(daemon, SIGKILL);
  EXPECT_TRUE(WIFSIGNALED(wait_status_of(daemon)));
  const int status = wait_status_of(cpu);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

}  // namespace

}  // namespace limb_ring::runtime
