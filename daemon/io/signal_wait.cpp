#include "io/signal_wait.h"

#include <algorithm>

namespace limb_ring::process {

SignalWait::SignalWait() {
  ::sigemptyset(&ours_);
  for (const int signal : {SIGINT, SIGTERM, SIGQUIT, SIGCHLD}) ::sigaddset(&ours_, signal);
  if (!ignores_hangup()) ::sigaddset(&ours_, SIGHUP);  // held back it would come even if it is ignored
  ::sigprocmask(SIG_SETMASK, nullptr, &before_);
  hold();
  ::signal(SIGCHLD, SIG_DFL);  // where our parent ignores it, nobody would be told of a child's end, nor how it ended
}

void SignalWait::hold() const { ::sigprocmask(SIG_BLOCK, &ours_, nullptr); }

void SignalWait::release() const { ::sigprocmask(SIG_SETMASK, &before_, nullptr); }

int SignalWait::note(int signal) const {
  asked_ = asked_ || asks_to_end(signal);
  return std::max(0, signal);
}

int SignalWait::next() const { return note(::sigwaitinfo(&ours_, nullptr)); }

int SignalWait::next(std::chrono::milliseconds timeout) const {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(timeout);
  const timespec wait{static_cast<time_t>(seconds.count()), static_cast<long>((timeout - seconds).count() * 1000000)};
  return note(::sigtimedwait(&ours_, nullptr, &wait));
}

}  // namespace limb_ring::process
