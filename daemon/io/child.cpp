#include "io/child.h"

#include <sys/wait.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>

namespace limb_ring::process {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kGrace{2000};
constexpr milliseconds kTick{10};

}  // namespace

Child::Child(Spawned process, std::string name) : name_(std::move(name)), process_(std::move(process)) {
  if (process_.pid < 0) ended_ = not_started(std::string("cannot fork: ") + std::strerror(process_.error));
}

bool Child::reap() {
  int wait_status = 0;
  if (ended_) return false;
  const pid_t waited = ::waitpid(process_.pid, &wait_status, WNOHANG);
  if (waited == 0) return false;
  note(waited, wait_status);
  return true;
}

void Child::note(pid_t waited, int wait_status) {
  const int error = exec_error(process_);
  if (error != 0)
    ended_ = not_executed(name_, error);
  else
    ended_ = waited == process_.pid ? exit_status(wait_status) : unknown_status();
}

void Child::signal(int number) const {
  if (!ended_) ::kill(process_.pid, number);
}

void Child::end() {
  reap();
  signal(SIGTERM);
  const auto deadline = steady_clock::now() + kGrace;
  while (!ended_ && steady_clock::now() < deadline) {
    std::this_thread::sleep_for(kTick);
    reap();
  }
  kill();
}

void Child::kill() {
  if (ended_) return;
  signal(SIGKILL);
  int wait_status = 0;
  pid_t waited = -1;
  do waited = ::waitpid(process_.pid, &wait_status, 0);
  while (waited < 0 && errno == EINTR);
  note(waited, wait_status);
}

}  // namespace limb_ring::process
