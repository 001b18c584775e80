#include "io/spawn.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>
#include <utility>

#ifndef SYS_close_range
#define SYS_close_range 436
#endif

extern char** environ;

namespace limb_ring::process {
namespace {

constexpr unsigned kCloseRangeCloexec = 4;  // CLOSE_RANGE_CLOEXEC, Linux 5.11
constexpr rlim_t kMostDescriptors = 65536;

/// Text lists made before the fork: nothing may be allocated after it.
struct TextList {
  std::vector<std::string> texts;
  std::vector<char*> pointers;

  explicit TextList(std::vector<std::string> list) : texts(std::move(list)) {
    for (auto& text : texts) pointers.push_back(text.data());
    pointers.push_back(nullptr);
  }
};

std::vector<std::string> merged_environment(const SpawnRequest& request) {
  std::vector<std::string> result;
  for (const auto& [name, value] : request.environment) result.push_back(name + "=" + value);
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const auto replaced = [&](const auto& pair) { return text.rfind(pair.first + "=", 0) == 0; };
    const auto& added = request.environment;
    if (std::none_of(added.begin(), added.end(), replaced)) result.push_back(text);
  }
  return result;
}

/// All signals held back, so that no handler of ours runs in the child before it has its own.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    ::sigfillset(&all);
    ::sigprocmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsBlocked() { ::sigprocmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_{};
};

// From here to exec the child uses system calls only.

[[noreturn]] void fail(int pipe) {
  const int error = errno;
  [[maybe_unused]] const ssize_t written = ::write(pipe, &error, sizeof error);
  ::_exit(127);
}

/// A Ctrl-C that came while the child was still in our group was not meant for it: to ignore a signal discards it where
/// it is pending. Others (SIGTERM, when we die) are kept.
void reset_signals() {
  for (const int from_terminal : {SIGINT, SIGQUIT, SIGTSTP}) ::signal(from_terminal, SIG_IGN);
  for (int number = 1; number < NSIG; ++number) ::signal(number, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

void die_with(pid_t parent, int death_signal) {
  if (death_signal == 0) return;
  ::prctl(PR_SET_PDEATHSIG, death_signal);
  if (::getppid() != parent) ::_exit(127);  // the parent ended before prctl took effect
}

void redirect(int output) {
  const int null = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (null >= 0) ::dup2(null, STDIN_FILENO);
  if (output < 0) return;
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
}

/// A daemon under SCHED_FIFO must not hand its priority to a CPU that may spin; SCHED_BATCH is the daemon's own.
void leave_realtime(const std::optional<cpu_set_t>& affinity) {
  const int policy = ::sched_getscheduler(0);
  const sched_param ordinary{};
  if (policy == SCHED_FIFO || policy == SCHED_RR || policy == SCHED_BATCH)
    ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  if (affinity) ::sched_setaffinity(0, sizeof *affinity, &*affinity);
}

[[noreturn]] void become(const SpawnRequest& request, TextList& arguments, TextList& environment, pid_t parent,
                         int pipe) {
  die_with(parent, request.death_signal);  // first: until then it could outlive us if stopped
  if (request.group == SpawnRequest::Group::session)
    ::setsid();
  else
    ::setpgid(0, 0);
  redirect(request.output);
  close_descriptors_on_exec();
  leave_realtime(request.affinity);
  reset_signals();
  if (!request.folder.empty() && ::chdir(request.folder.c_str()) != 0) fail(pipe);
  ::execve(request.path.c_str(), arguments.pointers.data(), environment.pointers.data());
  fail(pipe);
}

[[noreturn]] void run_copy(const std::function<int()>& work, pid_t parent, int death_signal) noexcept {
  die_with(parent, death_signal);
  ::_exit(work());
}

}  // namespace

void close_descriptors_on_exec() {
  if (::syscall(SYS_close_range, 3U, ~0U, kCloseRangeCloexec) == 0) return;
  rlimit limit{};
  ::getrlimit(RLIMIT_NOFILE, &limit);
  const int end = static_cast<int>(std::min(limit.rlim_cur, kMostDescriptors));
  for (int fd = 3; fd < end; ++fd) ::fcntl(fd, F_SETFD, FD_CLOEXEC);
}

Spawned spawn(const SpawnRequest& request) {
  TextList arguments(request.arguments);
  TextList environment(merged_environment(request));
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) return {-1, errno, UniqueFd{}};
  UniqueFd read_end(ends[0]), write_end(ends[1]);
  const pid_t parent = ::getpid();
  const SignalsBlocked blocked;
  const pid_t pid = ::fork();
  if (pid == 0) become(request, arguments, environment, parent, write_end.get());
  if (pid < 0) return {-1, errno, UniqueFd{}};
  // The child does so too; whoever is first, the group exists before anybody signals it.
  if (request.group == SpawnRequest::Group::own) ::setpgid(pid, pid);
  return {pid, 0, std::move(read_end)};
}

Spawned spawn_copy(const std::function<int()>& work, int death_signal) {
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid == 0) run_copy(work, parent, death_signal);
  if (pid < 0) return {-1, errno, UniqueFd{}};
  return {pid, 0, UniqueFd{}};
}

int exec_error(const Spawned& child) {
  int error = 0;
  if (::read(child.exec_error.get(), &error, sizeof error) != sizeof error) return 0;
  return error;
}

// open() gives the lowest free number, so each gets its own.
void open_standard_descriptors() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(fd, F_GETFD) < 0) ::open("/dev/null", O_RDWR);
}

void outlive_file_limit() { std::signal(SIGXFSZ, SIG_IGN); }

ExitStatus exit_status(int wait_status) {
  if (WIFSIGNALED(wait_status)) {
    const int number = WTERMSIG(wait_status);
    return {true, false, true, "signal " + std::to_string(number) + " (" + ::strsignal(number) + ")", {}};
  }
  const int code = WEXITSTATUS(wait_status);
  return {true, code == 0, false, "exit " + std::to_string(code), code};
}

ExitStatus unknown_status() { return {true, false, false, "ended, status unknown (SIGCHLD is ignored)", {}}; }

ExitStatus not_executed(const std::string& path, int error) {
  return not_started("cannot execute " + path + ": " + std::generic_category().message(error));
}

ExitStatus not_started(std::string why) { return {false, false, false, std::move(why), {}}; }

}  // namespace limb_ring::process
