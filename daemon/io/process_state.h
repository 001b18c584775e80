#pragma once

#include <sys/types.h>

#include <chrono>
#include <iosfwd>
#include <optional>
#include <string>

#include "io/unique_fd.h"

namespace limb_ring::process {

/// What the kernel says a process does: 'R' runs, 'S' waits, 'T' stopped, 't' stopped by a debugger, 'Z' ended but not
/// waited for ... (proc(5)); 0 if there is none.
char process_state(pid_t pid);
/// The same, out of an open /proc/PID/stat; 0 if the process has gone since that was opened.
char state_in(std::istream& stat);

/// Name of the program that it runs, as /proc has it; empty if there is none.
std::string program_of(pid_t pid);

/// How long its threads have run or have waited for a core, all together; nothing if the kernel does not say. The
/// rest of the time they slept.
std::optional<std::chrono::nanoseconds> time_not_asleep(pid_t pid);

inline bool is_stopped(pid_t pid) {
  const char state = process_state(pid);
  return state == 'T' || state == 't';
}
inline bool is_gone(pid_t pid) {
  const char state = process_state(pid);
  return state == 0 || state == 'Z' || state == 'X';
}

/// One process, and never another that was given its number later: held by a pidfd if the
/// kernel has them (5.3 and up), else by its number alone.
class ProcessHandle {
 public:
  enum class By { pidfd, number };

  ProcessHandle() = default;
  explicit ProcessHandle(pid_t pid, By by = By::pidfd);

  pid_t pid() const { return pid_; }
  /// -1 if the process is held by its number. Readable once the process has ended.
  int fd() const { return fd_.get(); }
  /// True if the process has ended. Held by number, one that ended without being waited for
  /// still counts as there.
  bool ended() const;
  /// @return false if the process is gone or not ours to signal.
  bool signal(int number) const;

 private:
  pid_t pid_ = -1;
  UniqueFd fd_;
};

/// A pidfd of `pid`; -1 with errno set if the kernel has none or the process is gone.
int open_pidfd(pid_t pid);

/// Tells systemd that this process is ready, if it was started as a service of Type=notify (NOTIFY_SOCKET is set);
/// else nothing. As sd_notify(3) has it, whose library this spares us.
/// @param status a line for `systemctl status`
void tell_ready(const std::string& status);

/// Empties the file to which standard error is appended, if it lies in that folder and is longer than `most` bytes.
/// A file of somebody else is left as it is.
/// @return whether it has emptied it
bool empty_long_log(const std::string& folder, off_t most);

}  // namespace limb_ring::process
