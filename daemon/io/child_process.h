#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/signal_set.hpp>
#include <functional>
#include <memory>
#include <optional>

#include "io/exit_status.h"
#include "io/process_handle.h"
#include "io/spawn.h"

namespace limb_ring::process {

/// One child at a time, with the process group it leads. Watched by pidfd, or by SIGCHLD where
/// the kernel has none; reaped by its number only, so that other children of this process are
/// left to their owners. What is left of the group is killed when its leader ends.
class ChildProcess {
 public:
  using OnExit = std::function<void(const ExitStatus&)>;

  explicit ChildProcess(boost::asio::io_context& io, ProcessHandle::By by = ProcessHandle::By::pidfd);
  /// As kill().
  ~ChildProcess() { kill(); }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Starts a child; `on_exit` is called once from the event loop when it has ended, also where
  /// the program could not be executed or even forked. It may start the next one.
  /// @pre !running()
  void start(const SpawnRequest& request, OnExit on_exit);
  /// Started, and its end not yet reported.
  bool running() const { return on_exit_ != nullptr; }
  pid_t pid() const { return child_.pid; }
  /// Signals the whole group; nothing happens where there is none.
  void signal_group(int number) const;
  /// Kills the group, and reaps the child if it goes within a second. Nothing is reported.
  void kill();
  /// True where `pid` is of the child's group.
  bool owns(pid_t pid) const;

 private:
  void watch();
  void watch_pidfd(int fd);
  void watch_signals();
  void poll();
  void report(const ExitStatus& status);
  void report_later(const ExitStatus& status);
  std::optional<ExitStatus> reap();
  void wait_for_end() const;

  boost::asio::io_context& io_;
  ProcessHandle::By by_;
  Spawned child_;
  std::string path_;
  OnExit on_exit_;
  boost::asio::posix::stream_descriptor exited_;
  boost::asio::signal_set child_signals_;
  /// Ends with this object, so that a handler already queued does nothing.
  std::shared_ptr<ChildProcess*> self_;
};

}  // namespace limb_ring::process
