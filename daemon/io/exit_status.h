#pragma once

#include <optional>
#include <string>

namespace limb_ring::process {

/// How a child ended.
struct ExitStatus {
  bool executed = true;  ///< false: the program could not be started at all
  bool clean = false;    ///< exit 0
  bool by_signal = false;
  std::string text;         ///< "exit 3", "signal 9 (Killed)", or why it could not be started
  std::optional<int> code;  ///< where it ended by exit
};

/// From what waitpid gives.
ExitStatus exit_status(int wait_status);
/// Of one that somebody else has waited for: the kernel, where SIGCHLD is ignored.
ExitStatus unknown_status();
/// The program at `path` could not be executed.
ExitStatus not_executed(const std::string& path, int error);
ExitStatus not_started(std::string why);

}  // namespace limb_ring::process
