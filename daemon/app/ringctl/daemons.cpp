#include "app/ringctl/daemons.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <fstream>

#include "app/ringctl/problems.h"
#include "limb_ring/ring_directory.h"
#include "process/find_program.h"

namespace limb_ring::ringctl {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr milliseconds kTick{50};
constexpr std::size_t kLastLines = 5;

std::string find_ringd() {
  const std::string path = process::find_program("ringd");
  if (path.empty())
    throw NotDone("no program ringd beside ringctl (" + process::own_folder() + ") or on PATH");
  return path;
}

process::UniqueFd open_log(const std::string& path) {
  process::UniqueFd file(
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!file.valid()) throw NotDone("cannot write " + path + ": " + std::strerror(errno));
  return file;
}

process::SpawnRequest request_for(const RingPlan& plan, const NodeName& node,
                                  const std::string& ringd) {
  process::SpawnRequest request;
  request.path = ringd;
  request.arguments = plan.arguments_of(node);
  request.arguments.insert(request.arguments.begin(), "ringd");
  request.death_signal = SIGTERM;
  return request;
}

Daemon start(const RingPlan& plan, const NodeName& node, const std::string& ringd,
             const std::string& log, Daemons::Mode mode) {
  process::SpawnRequest request = request_for(plan, node, ringd);
  process::UniqueFd output;
  if (!log.empty()) {
    output = open_log(log);
    request.output = output.get();
  }
  if (mode == Daemons::Mode::detached) {
    request.group = process::SpawnRequest::Group::session;
    request.death_signal = 0;
  }
  if (mode == Daemons::Mode::kept) request.death_signal = SIGKILL;  // one that is stopped would not see another
  Daemon daemon{node, process::spawn(request), log, {}};
  if (daemon.process.pid < 0)
    daemon.ended = process::not_started(std::string("cannot fork: ") +
                                        std::strerror(daemon.process.error));
  return daemon;
}

/// Why a log has nothing in it: "; LOG: No space left on device"; empty where it can be written.
std::string why_empty(const std::string& log) {
  const process::UniqueFd file(::open(log.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | O_NOFOLLOW));
  if (file.valid() && ::write(file.get(), "\n", 1) == 1) return "";
  return "; " + log + ": " + std::strerror(errno);
}

std::string last_lines(const std::string& path) {
  std::ifstream file(path);
  std::deque<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    lines.push_back(line);
    if (lines.size() > kLastLines) lines.pop_front();
  }
  std::string text;
  for (const std::string& line : lines) text += "\n  " + line;
  return text.empty() ? why_empty(path) : text;
}

/// @return true where it has ended now
bool reap_one(Daemon& daemon) {
  int wait_status = 0;
  if (daemon.ended || ::waitpid(daemon.process.pid, &wait_status, WNOHANG) == 0) return false;
  const int error = process::exec_error(daemon.process);
  daemon.ended = error != 0 ? process::not_executed("ringd", error)
                            : process::exit_status(wait_status);
  return true;
}

}  // namespace

std::string Daemon::obituary() const {
  const std::string how = ended ? ended->text : "still runs";
  return "node " + label(node) + " ended: " + how + last_words();
}

std::string Daemon::last_words() const { return log.empty() ? "" : last_lines(log); }

Daemons::Daemons(const RingPlan& plan, Mode mode)
    : plan_(plan), mode_(mode), ringd_(find_ringd()), folder_(make_ring_directory(plan.ring)) {
  for (const PlannedNode& planned : plan.nodes) daemons_.push_back(started(planned.node));
}

Daemon Daemons::started(const NodeName& node) const {
  const std::string log = folder_ + "/" + std::to_string(node.id) + ".log";
  return start(plan_, node, ringd_, mode_ == Mode::foreground ? std::string{} : log, mode_);
}

void Daemons::start_again(std::size_t index) { daemons_[index] = started(daemons_[index].node); }

std::vector<const Daemon*> Daemons::reap() {
  std::vector<const Daemon*> ended;
  for (Daemon& daemon : daemons_)
    if (reap_one(daemon)) ended.push_back(&daemon);
  return ended;
}

bool Daemons::any_running() const {
  return std::any_of(daemons_.begin(), daemons_.end(),
                     [](const Daemon& daemon) { return !daemon.ended; });
}

const Daemon* Daemons::first_ended() const {
  const auto found = std::find_if(daemons_.begin(), daemons_.end(),
                                  [](const Daemon& daemon) { return daemon.ended.has_value(); });
  return found == daemons_.end() ? nullptr : &*found;
}

void Daemons::signal(int number) const {
  for (const Daemon& daemon : daemons_)
    if (!daemon.ended) ::kill(daemon.process.pid, number);
}

void Daemons::end(SignalWait& signals, milliseconds grace) {
  reap();
  signal(SIGTERM);
  signal(SIGCONT);  // one that is stopped would not see it
  const auto deadline = steady_clock::now() + grace;
  bool impatient = false;
  while (any_running() && !impatient && steady_clock::now() < deadline) {
    impatient = SignalWait::asks_to_end(signals.next(kTick));
    reap();
  }
  signal(SIGKILL);
  const auto last = steady_clock::now() + grace;
  while (any_running() && steady_clock::now() < last) {
    signals.next(kTick);
    reap();
  }
}

}  // namespace limb_ring::ringctl
