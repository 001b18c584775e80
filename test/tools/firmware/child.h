#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace limb_ring::test {

/// A program started by a test; killed with it where it has not ended.
class Child {
 public:
  Child(std::vector<std::string> command, std::string stderr_file) : stderr_file_(std::move(stderr_file)) {
    std::vector<char*> arguments;
    for (auto& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, stderr_file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int error = posix_spawn(&pid_, arguments[0], &files, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) throw std::runtime_error("cannot start " + command[0]);
  }
  ~Child() {
    if (ended()) return;
    kill(SIGKILL);
    waitpid(pid_, &status_, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void kill(int signal) const { ::kill(pid_, signal); }
  pid_t pid() const { return pid_; }
  bool ended() {
    if (!ended_) ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
    return ended_;
  }
  /// Its exit code. @pre ended()
  int code() const { return WIFEXITED(status_) ? WEXITSTATUS(status_) : -1; }
  std::string said() const { return content(stderr_file_); }
  /// Whether `signal` was sent to it and it does not take it.
  bool leaves_pending(int signal) const {
    const std::string pending = status("ShdPnd:");
    return !pending.empty() && (std::stoull(pending, nullptr, 16) >> (signal - 1) & 1) != 0;
  }
  /// How often it has given its core up so far, to sleep or to wait for something.
  std::uint64_t waits() const { return std::stoull(status("voluntary_ctxt_switches:")); }

 private:
  /// What /proc says of it under that name; empty if it has ended.
  std::string status(const std::string& name) const {
    std::istringstream lines(content("/proc/" + std::to_string(pid_) + "/status"));
    for (std::string line; std::getline(lines, line);)
      if (line.rfind(name, 0) == 0) return line.substr(name.size());
    return {};
  }
  static std::string content(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::string stderr_file_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

}  // namespace limb_ring::test
