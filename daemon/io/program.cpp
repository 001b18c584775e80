#include "io/program.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <deque>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "io/find_program.h"
#include "io/regular_file.h"

namespace limb_ring::process {
namespace {

constexpr std::size_t kLastLines = 5;
constexpr off_t kLastWords = 4096;  // bytes

[[noreturn]] void cannot_write(const std::string& path) {
  throw std::runtime_error("cannot write " + path + ": " + why_not_opened(path));
}

/// Reserves room on the disk without writing: where the disk gets full, the program can still say why it ends.
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

}  // namespace limb_ring::process
