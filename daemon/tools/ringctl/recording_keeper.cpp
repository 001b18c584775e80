#include "tools/ringctl/recording_keeper.h"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/node_notes.h"
#include "judge/recording.h"
#include "ring/observed_daemon.h"
#include "ring/ring_files.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {

namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// How long to wait before saving, so that the consequences are recorded as well.
constexpr milliseconds kLater{300};
/// Not more often than this: one cause shows in many ways. A crash is always a cause, so its save is made later then.
constexpr std::chrono::seconds kBetween{5};

/// "2026-11-23_061508_123"
std::string date_text() {
  const auto now = std::chrono::system_clock::now();
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  std::tm local{};
  ::localtime_r(&seconds, &local);
  char text[64];
  std::strftime(text, sizeof text, "%Y-%m-%d_%H%M%S", &local);
  const auto ms = std::chrono::duration_cast<milliseconds>(now.time_since_epoch()).count() % 1000;
  const std::string digits = std::to_string(1000 + ms);
  return text + ("_" + digits.substr(1));
}

}  // namespace

RecordingKeeper::RecordingKeeper(const RingAccess& ring, Options options)
    : ring_(ring.ring()), folder_(ring.ring()), options_(std::move(options)) {
  live::PromiseWatch::Ring watched{ring_, {}, ring.folds_back()};
  // A ring that has been started may lose a daemon before we look. While it is started, a lock file may be of the ring
  // before it.
  const bool started = live::held_up_lock(folder_.path()).empty();
  for (const NodeName& node : ring.nodes_here()) {
    const pid_t pid = started ? live::holder_of(folder_.path(), node.id).pid : -1;
    nodes_.push_back({node, pid, live::ObservedDaemon(ring_, node.id, R"({"kinds": ["state"]})")});
    watched.nodes.push_back(node.id);
  }
  if (options_.when.count("promise") != 0)
    watch_.emplace(watched, [this](const promises::Breach& breach) {
      want("promise", std::string("promise broken: ") + to_string(breach.promise) + ": " + breach.what);
    });
}

void RecordingKeeper::poll() {
  if (watch_) judge();
  for (Node& node : nodes_) {
    if (options_.when.count("crash") != 0) look_for_crash(node);
    if (options_.when.count("break") != 0) look_for_breaks(node);
  }
  if (!wanted_.empty() && Clock::now() >= due_) save();
}

// A node that cannot be watched, as where its disk is full, may crash all the same.
void RecordingKeeper::judge() {
  try {
    watch_->poll();
  } catch (const live::NotDone& problem) {
    tell_user(std::string("not all promises are judged: ") + problem.what());
  }
}

// A crash leaves the socket ID.host behind: a daemon that ends cleanly removes it. Daemons killed on purpose are noted
// (io/node_notes.h) and do not count. On a virtual ring the process outlives a killed node.
void RecordingKeeper::look_for_crash(Node& node) {
  const live::Holder holder = live::holder_of(folder_.path(), node.name.id);
  const pid_t before = std::exchange(node.pid, holder.held || holder.on_virtual_ring ? holder.pid : -1);
  if (before <= 0 || holder.pid < 0 || node.pid == before) return;
  const bool left_its_socket =
      node.pid > 0 || fs::exists(folder_.path() + '/' + std::to_string(node.name.id) + ".host");
  if (left_its_socket && !live::was_killed(folder_.path(), wire::NodeId{node.name.id}, before))
    want("crash", "node " + label(node.name) + " has crashed");
}

void RecordingKeeper::look_for_breaks(Node& node) {
  if (!node.states.look_for()) return;
  while (const auto state = node.states.next()) hear(*state);
}

void RecordingKeeper::hear(const std::string& text) {
  const auto state = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!state.is_object() || !state.contains("broken_line")) return;
  const auto& line = state["broken_line"];
  if (!line.is_object()) return broken_.clear();
  const std::pair<int, int> ends{line.value("before", -1), line.value("behind", -1)};
  if (broken_.insert(ends).second)
    want("break",
         "the line from node " + std::to_string(ends.first) + " to " + std::to_string(ends.second) + " is broken");
}

void RecordingKeeper::want(const std::string& what, const std::string& words) {
  if (!wanted_.empty()) return tell_user(words + "; the save that is about to be made has it, too");
  const Clock::time_point now = Clock::now(), next = last_ ? *last_ + kBetween : now;
  if (what != "crash" && now < next) return tell_user(words + "; not saved, so soon after the last save");
  wanted_ = what;
  words_ = words;
  due_ = std::max(now + kLater, next);
}

void RecordingKeeper::save() {
  const std::string prefix = ring_ + '-';
  const std::string to = options_.folder + '/' + prefix + date_text() + '-' + std::exchange(wanted_, "");
  last_ = Clock::now();
  try {
    const recorder::SavedRing saved = recorder::save_ring(folder_.path(), to);
    for (const std::string& problem : saved.problems) tell_user("not saved: " + problem);
    if (saved.recordings != 0)
      recorder::remove_old_saves(to, prefix, options_.keep);
    else
      fs::remove(to);  // empty
    tell_user(words_ + (saved.recordings != 0 ? "; recordings are saved in " + to : "; no recordings could be saved"));
  } catch (const std::exception& problem) {
    tell_user(words_ + "; recordings cannot be saved: " + problem.what());
  }
}

}  // namespace limb_ring::ringctl
