#pragma once

#include <sched.h>
#include <sys/types.h>

#include <csignal>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/unique_fd.h"

namespace limb_ring::process {

/// What to start, and how. The child gets the default signal handlers, an empty signal mask,
/// /dev/null as input, and no descriptor but 0, 1 and 2; a real-time policy and SCHED_BATCH are not passed on.
struct SpawnRequest {
  std::string path;                                              ///< of the program, as find_program() gives it
  std::vector<std::string> arguments;                            ///< including the program's name as the first
  std::vector<std::pair<std::string, std::string>> environment;  ///< added to, or replacing, ours
  /// Sent to the child when this process ends, however it ends; 0: it lives on.
  int death_signal = SIGKILL;
  enum class Group { own, session } group = Group::own;  ///< led by the child
  std::string folder;                                    ///< it works in; empty: as this process
  int output = -1;                                       ///< descriptor for its output and errors; -1: ours
  std::optional<cpu_set_t> affinity;                     ///< cores it may use; empty: as this process
};

/// A child that was just forked; it may yet fail to execute its program.
struct Spawned {
  pid_t pid = -1;       ///< -1: not even forked; see `error`
  int error = 0;        ///< errno of a failed fork
  UniqueFd exec_error;  ///< see exec_error()
};

/// All descriptors of this process but 0, 1 and 2 are closed when it executes a program. System calls only.
void close_descriptors_on_exec();

/// Starts a program with fork and exec, without waiting for either.
Spawned spawn(const SpawnRequest& request);

/// Starts a copy of this process with fork, without waiting for it: it runs `work`, which must not throw, and ends with
/// what that returns. Exit handlers do not run, unless `work` calls exit() itself. It stays in this process's group,
/// and keeps all that a fork leaves it.
/// @param death_signal as SpawnRequest's
/// @pre this process has one thread
Spawned spawn_copy(const std::function<int()>& work, int death_signal = SIGKILL);

/// errno of the exec of a child that has ended; 0 if its program was started.
int exec_error(const Spawned& child);

/// Opens /dev/null in the place of standard input, output and errors that this process was started without (2>&-):
/// else a file or socket opened later gets that number, and what is printed goes into it. The first thing in main();
/// programs started from here have them, too.
void open_standard_descriptors();

/// Ignores the signal that ends a process whose file gets longer than it may (ulimit -f): writing fails then, and that
/// is reported. Programs started by spawn() and execute() do not inherit it.
void outlive_file_limit();

/// How a child ended.
struct ExitStatus {
  bool executed = true;  ///< false: the program could not be started at all
  bool clean = false;    ///< exit 0
  bool by_signal = false;
  std::string text;         ///< "exit 3", "signal 9 (Killed)", or why it could not be started
  std::optional<int> code;  ///< if it ended by exit
};

/// From what waitpid gives.
ExitStatus exit_status(int wait_status);
/// Of one that somebody else has waited for: the kernel, if SIGCHLD is ignored.
ExitStatus unknown_status();
/// The program at `path` could not be executed.
ExitStatus not_executed(const std::string& path, int error);
ExitStatus not_started(std::string why);

}  // namespace limb_ring::process
