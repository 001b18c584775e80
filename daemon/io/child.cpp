#include "io/child.h"

#include <sys/wait.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>

namespace limb_ring::process {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kGrace{2000};
constexpr milliseconds kTick{10};

}  // namespace

Child::Child(Spawned process, std::string name) : name_(std::move(name)), process_(std::move(process)) {
  if (process_.pid < 0) ended_ = not_started(std::string("cannot fork: ") + std::strerror(process_.error));
}

bool Child::reap() {
  int wait_status = 0;
  if (ended_) return false;
  const pid_t waited = ::waitpid(process_.pid, &wait_status, WNOHANG);
  if (waited == 0) return false;
  note(waited, wait_status);
  return true;
}

void Child::note(pid_t waited, int wait_status) {
  const int error = exec_error(process_);
  if (error != 0)
    ended_ = not_executed(name_, error);
  else
    ended_ = waited == process_.pid ? exit_status(wait_status) : unknown_status();
}

void Child::signal(int number) const {
  if (!ended_) ::kill(process_.pid, number);
}

void Child::end() {
  reap();
  signal(SIGTERM);
  const auto deadline = steady_clock::now() + kGrace;
  while (!ended_ && steady_clock::now() < deadline) {
    std::this_thread::sleep_for(kTick);
    reap();
  }
  kill();
}

void Child::kill() {
  if (ended_) return;
  signal(SIGKILL);
  int wait_status = 0;
  pid_t waited = -1;
  do waited = ::waitpid(process_.pid, &wait_status, 0);
  while (waited < 0 && errno == EINTR);
  note(waited, wait_status);
}

namespace {

constexpr milliseconds kLastWait{1000};

/// Has it ended? It is left as it is, so that its number cannot be given to another yet.
bool has_ended(pid_t pid) {
  siginfo_t info{};
  const int got = ::waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT);
  // ECHILD: somebody ignores SIGCHLD, and the kernel has reaped it for us.
  return got == 0 ? info.si_pid == pid : errno == ECHILD;
}

}  // namespace

ChildProcess::ChildProcess(boost::asio::io_context& io, ProcessHandle::By by)
    : io_(io), by_(by), exited_(io), child_signals_(io), self_(std::make_shared<ChildProcess*>(this)) {}

void ChildProcess::kill() {
  if (child_.pid <= 0) return;
  signal_group(SIGKILL);
  wait_for_end();
  reap();
}

void ChildProcess::start(const SpawnRequest& request, OnExit on_exit) {
  on_exit_ = std::move(on_exit);
  path_ = request.path;
  child_ = spawn(request);
  if (child_.pid > 0)
    watch();
  else
    report_later(not_started("cannot fork: " + std::generic_category().message(child_.error)));
}

void ChildProcess::signal_group(int number) const {
  if (child_.pid > 0) ::kill(-child_.pid, number);
}

bool ChildProcess::owns(pid_t pid) const {
  return child_.pid > 0 && (pid == child_.pid || ::getpgid(pid) == child_.pid);
}

void ChildProcess::watch() {
  const int fd = by_ == ProcessHandle::By::pidfd ? open_pidfd(child_.pid) : -1;
  if (fd >= 0)
    watch_pidfd(fd);
  else
    watch_signals();
}

void ChildProcess::watch_pidfd(int fd) {
  exited_.assign(fd);
  exited_.async_wait(exited_.wait_read, [self = std::weak_ptr(self_)](const auto& error) {
    const auto alive = self.lock();
    if (alive && !error) (*alive)->poll();
  });
}

void ChildProcess::watch_signals() {
  boost::system::error_code ignored;
  child_signals_.add(SIGCHLD, ignored);
  child_signals_.async_wait([self = std::weak_ptr(self_)](const auto& error, int) {
    const auto alive = self.lock();
    if (alive && !error) (*alive)->poll();
  });
  // It may have ended before the handler was in place.
  boost::asio::post(io_, [self = std::weak_ptr(self_), pid = child_.pid] {
    const auto alive = self.lock();
    if (alive && (*alive)->child_.pid == pid && has_ended(pid)) (*alive)->poll();
  });
}

void ChildProcess::poll() {
  if (child_.pid <= 0) return;
  const auto status = reap();
  if (status)
    report(*status);
  else
    watch_signals();  // SIGCHLD of another child, or a pidfd that was readable too early
}

/// The group first: once its leader is reaped, its number may belong to others.
std::optional<ExitStatus> ChildProcess::reap() {
  if (!has_ended(child_.pid)) return std::nullopt;
  signal_group(SIGKILL);
  int wait_status = 0;
  const bool reaped = ::waitpid(child_.pid, &wait_status, WNOHANG) == child_.pid;
  const int error = exec_error(child_);
  child_ = Spawned{};
  if (error != 0) return not_executed(path_, error);
  if (!reaped) return unknown_status();
  return exit_status(wait_status);
}

void ChildProcess::report(const ExitStatus& status) {
  boost::system::error_code ignored;
  exited_.close(ignored);
  child_signals_.clear(ignored);
  child_signals_.cancel(ignored);
  const OnExit on_exit = std::exchange(on_exit_, nullptr);
  on_exit(status);
}

void ChildProcess::report_later(const ExitStatus& status) {
  boost::asio::post(io_, [self = std::weak_ptr(self_), status] {
    if (const auto alive = self.lock()) (*alive)->report(status);
  });
}

void ChildProcess::wait_for_end() const {
  const auto deadline = steady_clock::now() + kLastWait;
  while (!has_ended(child_.pid) && steady_clock::now() < deadline) std::this_thread::sleep_for(milliseconds(1));
}

BackOff::milliseconds BackOff::after(milliseconds ran) {
  if (ran >= limits_.steady) reset();
  const milliseconds wait = next_;
  next_ = std::min(next_ * 2, limits_.most);
  return wait;
}

}  // namespace limb_ring::process
