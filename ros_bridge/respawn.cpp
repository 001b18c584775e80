#include "ros_bridge/respawn.h"

#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <iostream>
#include <string>
#include <system_error>

namespace limb_ring::bridge {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int kWrongParameters = 2;
constexpr milliseconds kFirstWait{100}, kLongestPause{5000};
constexpr milliseconds kSteady{10000};  // after so long a child was no failure

/// The signals that the parent waits for, held back as long as this lives.
class HeldSignals {
 public:
  HeldSignals() {
    ::sigemptyset(&ours_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) ::sigaddset(&ours_, signal);
    ::sigprocmask(SIG_BLOCK, &ours_, &before_);
  }
  void release() const { ::sigprocmask(SIG_SETMASK, &before_, nullptr); }
  int next() const { return ::sigwaitinfo(&ours_, nullptr); }
  /// @return the signal; negative where none came in that time
  int next(milliseconds timeout) const {
    const timespec wait{timeout.count() / 1000, timeout.count() % 1000 * 1000000};
    return ::sigtimedwait(&ours_, nullptr, &wait);
  }

 private:
  sigset_t ours_{}, before_{};
};

bool asks_to_end(int signal) { return signal > 0 && signal != SIGCHLD; }

struct End {
  int wait_status = 0;
  bool asked = false;  ///< to end, while it ran
};

End wait_for(pid_t child, const HeldSignals& signals) {
  End end;
  while (::waitpid(child, &end.wait_status, WNOHANG) == 0) {
    const int signal = signals.next();
    if (!asks_to_end(signal)) continue;
    end.asked = true;
    ::kill(child, signal);
  }
  return end;
}

std::string text_of(int wait_status) {
  if (WIFEXITED(wait_status)) return "exit " + std::to_string(WEXITSTATUS(wait_status));
  return "signal " + std::to_string(WTERMSIG(wait_status)) + " (" + ::strsignal(WTERMSIG(wait_status)) + ")";
}

int exit_code(int wait_status) { return WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 1; }

/// @return true where the parent is asked to end meanwhile
bool wait_before_next(milliseconds wait, const HeldSignals& signals) {
  const auto until = steady_clock::now() + wait;
  for (auto now = steady_clock::now(); now < until; now = steady_clock::now())
    if (asks_to_end(signals.next(std::chrono::ceil<milliseconds>(until - now)))) return true;
  return false;
}

}  // namespace

int respawned(const std::function<int()>& program) {
  const HeldSignals signals;
  const pid_t parent = ::getpid();
  for (milliseconds wait = kFirstWait;; wait = std::min(wait * 2, kLongestPause)) {
    const auto start = steady_clock::now();
    const pid_t child = ::fork();
    if (child < 0) throw std::system_error(errno, std::generic_category(), "cannot fork");
    if (child == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGTERM);
      if (::getppid() != parent) return 1;  // it is gone already
      signals.release();
      return program();
    }
    const End end = wait_for(child, signals);
    const int code = exit_code(end.wait_status);
    if (end.asked || code == kWrongParameters) return code;
    if (steady_clock::now() - start >= kSteady) wait = kFirstWait;
    std::cerr << "the process ended with " << text_of(end.wait_status) << " and is started again" << std::endl;
    if (wait_before_next(wait, signals)) return code;
  }
}

}  // namespace limb_ring::bridge
