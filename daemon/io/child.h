#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

#include "io/exit_status.h"
#include "io/spawn.h"

namespace limb_ring::process {

/// A child of this process that is asked now and then whether it has ended; an event loop watches one by ChildProcess.
/// It goes on when this object is gone.
class Child {
 public:
  /// @param name for people
  Child(Spawned process, std::string name);

  pid_t pid() const { return process_.pid; }
  /// Notes whether it has ended. @return true where it has since the last call
  bool reap();
  /// How it ended, as far as reap() knows; empty: it runs.
  const std::optional<ExitStatus>& ended() const { return ended_; }
  /// Nothing happens once it has ended.
  void signal(int number) const;
  /// SIGTERM, and SIGKILL where it takes longer than two seconds; returns when it has ended.
  void end();
  /// SIGKILL; returns when it has ended.
  void kill();

 private:
  /// @param waited what waitpid has returned
  void note(pid_t waited, int wait_status);

  std::string name_;
  Spawned process_;
  std::optional<ExitStatus> ended_;
};

}  // namespace limb_ring::process
