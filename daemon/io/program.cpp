#include "io/program.h"

#include <fcntl.h>
#include <limits.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "io/regular_file.h"

namespace limb_ring::process {
namespace {

constexpr std::size_t kLastLines = 5;
constexpr off_t kLastWords = 4096;  // bytes

[[noreturn]] void cannot_write(const std::string& path) {
  throw std::runtime_error("cannot write " + path + ": " + why_not_opened(path));
}

/// Reserves room on the disk without writing: if the disk gets full, the program can still say why it ends.
/// Not all file systems can; on those the program has what is left. A limit on files (ulimit -f) that leaves no such
/// room is refused everywhere: not all file systems look at it here.
void reserve_last_words(int log, const std::string& path) {
  rlimit most{};
  if (::getrlimit(RLIMIT_FSIZE, &most) == 0 && most.rlim_cur < static_cast<rlim_t>(kLastWords)) {
    errno = EFBIG;
    cannot_write(path);
  }
  if (::fallocate(log, FALLOC_FL_KEEP_SIZE, 0, kLastWords) != 0 && (errno == ENOSPC || errno == EDQUOT))
    cannot_write(path);
}

UniqueFd open_log(const std::string& path) {
  UniqueFd file = open_regular(path, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND);
  if (!file.valid()) cannot_write(path);
  reserve_last_words(file.get(), path);
  return file;
}

std::string path_of(const std::string& name) {
  const std::string path = find_program(name);
  if (path.empty())
    throw std::runtime_error("no program " + name + " beside this one (" + own_folder() + ") or on PATH");
  return path;
}

int death_signal(Lifetime lifetime) {
  switch (lifetime) {
    case Lifetime::asked_to_end:
      return SIGTERM;
    case Lifetime::killed:
      return SIGKILL;
    case Lifetime::its_own:
      break;
  }
  return 0;
}

Spawned start(const ProgramRequest& request) {
  SpawnRequest what;
  what.path = path_of(request.name);
  what.arguments = request.arguments;
  what.arguments.insert(what.arguments.begin(), request.name);
  what.environment = request.environment;
  what.death_signal = death_signal(request.lifetime);
  if (request.lifetime == Lifetime::its_own) what.group = SpawnRequest::Group::session;
  what.affinity = request.cores;
  UniqueFd output;
  if (!request.log.empty()) {
    output = open_log(request.log);
    what.output = output.get();
  }
  return spawn(what);
}

}  // namespace

Program::Program(const ProgramRequest& request) : Child(start(request), request.name), log_(request.log) {}

std::string Program::output() const {
  std::ostringstream text;
  if (!log_.empty()) text << std::ifstream(log_).rdbuf();
  return text.str();
}

std::string Program::last_lines() const { return log_.empty() ? "" : last_lines_of(log_); }

std::string last_lines_of(const std::string& log) {
  std::ifstream file(log);
  std::deque<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    lines.push_back(line);
    if (lines.size() > kLastLines) lines.pop_front();
  }
  std::string text;
  for (const std::string& line : lines) text += "\n  " + line;
  return text.empty() ? "; " + log + " is empty" : text;
}

int execute(const std::string& path, std::vector<std::string> arguments) {
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  ::signal(SIGXFSZ, SIG_DFL);  // outlive_file_limit() was for this program
  ::execv(path.c_str(), pointers.data());
  return errno;
}

namespace {

bool executable_file(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && S_ISREG(info.st_mode) && ::access(path.c_str(), X_OK) == 0;
}

std::string find_on_path(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string candidate = (folder.empty() ? "." : folder) + "/" + name;
    if (executable_file(candidate)) return candidate;
  }
  return {};
}

std::string working_folder() {
  char path[PATH_MAX];
  return ::getcwd(path, sizeof path) != nullptr ? path : "a folder that is gone";
}

}  // namespace

std::string own_folder() {
  char path[PATH_MAX];
  const ssize_t size = ::readlink("/proc/self/exe", path, sizeof path);
  if (size <= 0) return {};
  const std::string full(path, static_cast<std::size_t>(size));
  return full.substr(0, full.rfind('/'));
}

std::string find_program(const std::string& name, const std::string& folder) {
  if (name.empty()) return {};
  if (name.find('/') != std::string::npos) return executable_file(name) ? name : std::string{};
  const std::string beside = folder + "/" + name;
  if (!folder.empty() && executable_file(beside)) return beside;
  return find_on_path(name);
}

std::string no_program(const std::string& name, const std::string& folder) {
  const std::string what = "no program '" + name + "' that can be executed";
  if (name.find('/') == std::string::npos) return what + " (looked in " + folder + " and on PATH)";
  if (name.front() == '/') return what;
  return what + " (seen from " + working_folder() + ")";
}

}  // namespace limb_ring::process
