#include "ring/launched_ring.h"

#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <csignal>

#include "io/process_state.h"
#include "limb_ring/ring_directory.h"
#include "ring/observed_daemon.h"
#include "ring/ring_files.h"

namespace limb_ring::live {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr milliseconds kTick{50};

}  // namespace

std::string LaunchedDaemon::exit_reason() const {
  const std::string how = ended() ? ended()->text : "still runs";
  const std::string what = all ? "the virtual ring" : "node " + std::to_string(id) + " (" + name + ")";
  return what + " ended: " + how + last_lines();
}

LaunchedRing::LaunchedRing(LaunchRequest request)
    : request_(std::move(request)), folder_(make_ring_directory(request_.ring)) {
  try {
    for (const LaunchRequest::Node& node : request_.nodes) daemons_.push_back(started(node));
  } catch (...) {
    signal(SIGTERM);
    for (LaunchedDaemon& daemon : daemons_) daemon.program.end();
    throw;
  }
}

LaunchedDaemon LaunchedRing::started(const LaunchRequest::Node& node) const {
  process::ProgramRequest ringd;
  ringd.name = "ringd";
  ringd.arguments = node.arguments;
  ringd.lifetime = request_.lifetime;
  ringd.cores = request_.cores;
  if (request_.logged) ringd.log = folder_ + "/" + (node.all ? kRingLog : std::to_string(node.id) + ".log");
  return {node.id, node.name, process::Program(ringd), node.all};
}

void LaunchedRing::start_again(std::size_t index) { daemons_[index] = started(request_.nodes[index]); }

std::vector<const LaunchedDaemon*> LaunchedRing::reap() {
  std::vector<const LaunchedDaemon*> ended;
  for (LaunchedDaemon& daemon : daemons_)
    if (daemon.program.reap()) ended.push_back(&daemon);
  return ended;
}

bool LaunchedRing::any_running() const {
  return std::any_of(daemons_.begin(), daemons_.end(), [](const auto& daemon) { return !daemon.ended(); });
}

const LaunchedDaemon* LaunchedRing::first_ended() const {
  const auto found =
      std::find_if(daemons_.begin(), daemons_.end(), [](const auto& daemon) { return daemon.ended().has_value(); });
  return found == daemons_.end() ? nullptr : &*found;
}

void LaunchedRing::signal(int number) const {
  for (const LaunchedDaemon& daemon : daemons_) daemon.program.signal(number);
}

void LaunchedRing::end(const Wait& wait, milliseconds grace) {
  reap();
  signal(SIGTERM);
  signal(SIGCONT);  // one that is stopped would not see it
  const auto deadline = steady_clock::now() + grace;
  bool at_once = false;
  while (any_running() && !at_once && steady_clock::now() < deadline) {
    at_once = wait(kTick);
    reap();
  }
  signal(SIGKILL);
  const auto last = steady_clock::now() + grace;
  while (any_running() && steady_clock::now() < last) {
    wait(kTick);
    reap();
  }
}

PrivateFolder::PrivateFolder() {
  replace("XDG_RUNTIME_DIR", path().c_str());
  replace("LIMB_RING_RING", nullptr);
  replace("LIMB_RING_NODE", nullptr);
}

PrivateFolder::~PrivateFolder() {
  for (const auto& [name, value] : before_) {
    if (value)
      ::setenv(name.c_str(), value->c_str(), 1);
    else
      ::unsetenv(name.c_str());
  }
}

void PrivateFolder::replace(const std::string& name, const char* value) {
  const char* old = ::getenv(name.c_str());
  before_[name] = old == nullptr ? std::nullopt : std::optional<std::string>(old);
  if (value != nullptr)
    ::setenv(name.c_str(), value, 1);
  else
    ::unsetenv(name.c_str());
}

using nlohmann::json;

namespace {

constexpr std::chrono::milliseconds kClockAnswer{2000};

bool answers_as_virtual(const std::string& ring) {
  const std::string folder = ring_directory(ring);
  const auto nodes = held_nodes(folder);
  return !nodes.empty() && holder_of(folder, nodes.front().node).on_virtual_ring &&
         !process::is_stopped(nodes.front().pid);
}

}  // namespace

json ring_clock(const std::string& ring) {
  if (!answers_as_virtual(ring)) return json();
  try {
    HostPort port = connect_ring(ring);
    json clock = json::parse(port.ask(R"({"do": "clock"})", kClockAnswer));
    clock["now_s"] = clock.at("now_ns").get<double>() / 1e9;
    clock.erase("now_ns");
    return clock;
  } catch (const std::exception&) {
    return json();  // it ends just now
  }
}

std::string standing_clock(const std::string& ring) {
  const json clock = ring_clock(ring);
  if (!clock.is_object() || !clock.value("paused", false)) return "";
  return "the virtual clock of ring " + ring + " stands; 'ringctl clock run' lets it go on";
}

std::string with_standing_clock(const std::string& problem, const std::string& ring) {
  const std::string standing = standing_clock(ring);
  return standing.empty() ? problem : problem + ": " + standing;
}

}  // namespace limb_ring::live
