#pragma once

#include <sys/types.h>

#include "io/unique_fd.h"

namespace limb_ring::process {

/// One process, and never another that was given its number later: held by a pidfd where the
/// kernel has them (5.3 and up), else by its number alone.
class ProcessHandle {
 public:
  enum class By { pidfd, number };

  ProcessHandle() = default;
  explicit ProcessHandle(pid_t pid, By by = By::pidfd);

  pid_t pid() const { return pid_; }
  /// -1 where the process is held by its number. Readable once the process has ended.
  int fd() const { return fd_.get(); }
  /// True where the process has ended. Held by number, one that ended without being waited for
  /// still counts as there.
  bool ended() const;
  /// @return false where the process is gone or not ours to signal.
  bool signal(int number) const;

 private:
  pid_t pid_ = -1;
  UniqueFd fd_;
};

/// A pidfd of `pid`; -1 with errno set where the kernel has none or the process is gone.
int open_pidfd(pid_t pid);

}  // namespace limb_ring::process
