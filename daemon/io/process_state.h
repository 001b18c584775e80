#pragma once

#include <sys/types.h>

#include <chrono>
#include <iosfwd>
#include <optional>
#include <string>

namespace limb_ring::process {

/// What the kernel says a process does: 'R' runs, 'S' waits, 'T' stopped, 't' stopped by a debugger, 'Z' ended but not
/// waited for ... (proc(5)); 0 where there is none.
char process_state(pid_t pid);
/// The same, out of an open /proc/PID/stat; 0 where the process has gone since that was opened.
char state_in(std::istream& stat);

/// Name of the program that it runs, as /proc has it; empty where there is none.
std::string program_of(pid_t pid);

/// How long its threads have run or have waited for a core, all together; nothing where the kernel does not say. The
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

}  // namespace limb_ring::process
