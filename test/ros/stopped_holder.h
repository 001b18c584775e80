#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "config/ring_config.h"
#include "limb_ring/ring_directory.h"
#include "node/host_server.h"

namespace limb_ring::bridge {

/// A process that holds a node of small_robot() as its daemon does, and is stopped.
class StoppedHolder {
 public:
  explicit StoppedHolder(const config::NodeConfig& node) : pid_(::fork()) {
    if (pid_ == 0) {
      const host::NodeLock held(make_ring_directory("small"), "small", node.id, node.name);
      ::raise(SIGSTOP);
      ::_exit(0);
    }
    ::waitpid(pid_, nullptr, WUNTRACED);
  }
  ~StoppedHolder() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  StoppedHolder(const StoppedHolder&) = delete;
  StoppedHolder& operator=(const StoppedHolder&) = delete;

 private:
  pid_t pid_;
};

}  // namespace limb_ring::bridge
