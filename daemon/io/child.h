#pragma once

#include <sys/types.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/signal_set.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "io/process_state.h"
#include "io/spawn.h"

namespace limb_ring::process {

/// A child of this process that is asked now and then whether it has ended; an event loop watches one by ChildProcess.
/// It goes on when this object is gone.
class Child {
 public:
  /// @param name for people
  Child(Spawned process, std::string name);

  pid_t pid() const { return process_.pid; }
  /// Notes whether it has ended. @return true if it has since the last call
  bool reap();
  /// How it ended, as far as reap() knows; empty: it runs.
  const std::optional<ExitStatus>& ended() const { return ended_; }
  /// Nothing happens once it has ended.
  void signal(int number) const;
  /// SIGTERM, and SIGKILL if it takes longer than two seconds; returns when it has ended.
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

/// One child at a time, with the process group it leads. Watched by pidfd, or by SIGCHLD if
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

  /// Starts a child; `on_exit` is called once from the event loop when it has ended, also if
  /// the program could not be executed or even forked. It may start the next one.
  /// @pre !running()
  void start(const SpawnRequest& request, OnExit on_exit);
  /// Started, and its end not yet reported.
  bool running() const { return on_exit_ != nullptr; }
  pid_t pid() const { return child_.pid; }
  /// Signals the whole group; nothing happens if there is none.
  void signal_group(int number) const;
  /// Kills the group, and reaps the child if it goes within a second. Nothing is reported.
  void kill();
  /// True if `pid` is of the child's group.
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

/// How long to wait before a child that ended is started again: `first`, doubling up to `most`,
/// and `first` again once it has run for `steady`. (ours)
class BackOff {
 public:
  using milliseconds = std::chrono::milliseconds;
  struct Limits {
    milliseconds first{100};
    milliseconds most{5000};
    milliseconds steady{10000};
  };

  explicit BackOff(const Limits& limits) : limits_(limits), next_(limits.first) {}

  /// The wait after a child that ran for `ran`.
  milliseconds after(milliseconds ran);
  void reset() { next_ = limits_.first; }

 private:
  Limits limits_;
  milliseconds next_;
};

}  // namespace limb_ring::process
