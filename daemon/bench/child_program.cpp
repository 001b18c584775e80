#include "bench/child_program.h"

#include <fcntl.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "process/find_program.h"

namespace limb_ring::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kGrace{2000};
constexpr milliseconds kTick{10};
constexpr std::size_t kLastWords = 600;

process::UniqueFd open_log(const std::string& path) {
  process::UniqueFd file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0600));
  if (!file.valid()) throw std::runtime_error("cannot write " + path);
  return file;
}

std::string found(const std::string& name) {
  const std::string path = process::find_program(name);
  if (path.empty())
    throw std::runtime_error("no program " + name + " beside this one (" + process::own_folder() + ") or on PATH");
  return path;
}

}  // namespace

ChildProgram::ChildProgram(const ProgramRequest& request) : name_(request.name), log_(request.log) {
  const process::UniqueFd output = open_log(log_);
  process::SpawnRequest spawn;
  spawn.path = found(request.name);
  spawn.arguments = request.arguments;
  spawn.arguments.insert(spawn.arguments.begin(), request.name);
  spawn.environment = request.environment;
  spawn.death_signal = SIGTERM;
  spawn.output = output.get();
  spawn.affinity = request.cores;
  process_ = process::spawn(spawn);
  if (process_.pid < 0) throw std::runtime_error("cannot start " + name_);
}

ChildProgram::ChildProgram(ChildProgram&& other) noexcept
    : name_(std::move(other.name_)), log_(std::move(other.log_)), process_(std::move(other.process_)) {
  other.process_.pid = -1;
}

bool ChildProgram::running() {
  if (process_.pid > 0 && ::waitpid(process_.pid, nullptr, WNOHANG) != 0) process_.pid = -1;
  return process_.pid > 0;
}

void ChildProgram::ask_to_end() {
  if (process_.pid > 0) ::kill(process_.pid, SIGTERM);
}

void ChildProgram::end() {
  ask_to_end();
  const auto deadline = steady_clock::now() + kGrace;
  while (running() && steady_clock::now() < deadline) std::this_thread::sleep_for(kTick);
  if (process_.pid <= 0) return;
  ::kill(process_.pid, SIGKILL);
  ::waitpid(process_.pid, nullptr, 0);
  process_.pid = -1;
}

std::string ChildProgram::output() const {
  std::ostringstream text;
  text << std::ifstream(log_).rdbuf();
  return text.str();
}

std::string ChildProgram::last_words() const {
  const std::string all = output();
  return all.size() <= kLastWords ? all : "..." + all.substr(all.size() - kLastWords);
}

}  // namespace limb_ring::bench
