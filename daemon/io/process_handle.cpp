#include "io/process_handle.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/syscall.h>

#include <cerrno>
#include <csignal>

// Older C libraries know neither the wrappers nor the numbers; these are the same on every
// architecture but alpha.
#ifndef SYS_pidfd_open
#define SYS_pidfd_open 434
#endif
#ifndef SYS_pidfd_send_signal
#define SYS_pidfd_send_signal 424
#endif

namespace limb_ring::process {

int open_pidfd(pid_t pid) {
  return static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));  // close-on-exec by itself
}

ProcessHandle::ProcessHandle(pid_t pid, By by) : pid_(pid) {
  if (by == By::number || pid <= 0) return;
  fd_.reset(open_pidfd(pid));
  if (!fd_.valid() && errno == ESRCH) pid_ = -1;
}

bool ProcessHandle::ended() const {
  if (pid_ <= 0) return true;
  if (!fd_.valid()) return ::kill(pid_, 0) != 0 && errno == ESRCH;
  pollfd exited{fd_.get(), POLLIN, 0};
  return ::poll(&exited, 1, 0) == 1;
}

bool ProcessHandle::signal(int number) const {
  if (pid_ <= 0) return false;
  if (!fd_.valid()) return ::kill(pid_, number) == 0;
  return ::syscall(SYS_pidfd_send_signal, fd_.get(), number, nullptr, 0) == 0;
}

}  // namespace limb_ring::process
