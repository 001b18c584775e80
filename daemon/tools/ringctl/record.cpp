#include <sys/types.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "config/ring_config.h"
#include "io/node_notes.h"
#include "io/signal_wait.h"
#include "judge/flight_recorder.h"
#include "judge/recording.h"
#include "judge/replay.h"
#include "limb_ring/ring_directory.h"
#include "ring/observed_daemon.h"
#include "ring/ring_files.h"
#include "tools/common/command_line.h"
#include "tools/common/ring_file.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/ring_folder.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {

/// Saves the recordings of a ring's nodes when something goes wrong, a bounded number of times. (ours)
class RecordingKeeper {
 public:
  struct Options {
    std::set<std::string> when;  ///< of "crash", "break", "promise"
    std::string folder;          ///< each save is a folder in it
    unsigned keep = 5;           ///< so many saves of this ring; older ones are removed
  };
  /// How often poll() is to be called.
  static constexpr std::chrono::milliseconds kRound = live::PromiseWatch::kRound;

  RecordingKeeper(const RingAccess& ring, Options options);

  /// Looks what has happened, and saves; tells on standard error where, or why it cannot.
  void poll();
  /// The ring was taken down.
  bool ring_is_gone() const { return folder_.is_gone(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Node {
    NodeName name;
    pid_t pid = -1;  ///< of its daemon, while it lives, or has not been looked for
    live::ObservedDaemon states;
  };

  void judge();
  void look_for_crash(Node& node);
  void look_for_breaks(Node& node);
  void hear(const std::string& text);
  /// Saves a little later, so that the consequences are recorded as well.
  void want(const std::string& what, const std::string& words);
  void save();

  std::string ring_;
  RingFolder folder_;
  Options options_;
  std::vector<Node> nodes_;
  std::set<std::pair<int, int>> broken_;  ///< lines that are, by the nodes at their ends
  std::optional<live::PromiseWatch> watch_;
  std::string wanted_, words_;  ///< empty: nothing
  Clock::time_point due_{};
  std::optional<Clock::time_point> last_;  ///< save
};

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

namespace {

std::string date_of(std::int64_t ns) {
  const std::time_t seconds = ns / 1'000'000'000;
  std::tm local{};
  ::localtime_r(&seconds, &local);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &local);
  return text;
}

/// One that cannot be read says so when it is replayed.
std::string ended_life(const std::string& ring_folder, const std::string& file) try {
  std::vector<std::uint8_t> bytes(recorder::kTitleSize);
  std::ifstream(file, std::ios::binary)
      .read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const recorder::Title title = recorder::read_title({bytes.data(), bytes.size()});
  if (!recorder::is_of_former_life(file) && live::holder_of(ring_folder, title.settings.id).held) return "";
  return "  " + std::filesystem::path(file).filename().string() + ": " + title.node + ", begun " + date_of(title.date) +
         '\n';
} catch (const std::exception&) {
  return "";
}

/// Of the recordings in `folder`, as `ringctl record save` has just put them there: those of lives that have ended, a
/// line each: "  3.record.former: node3, begun 2026-11-23 06:15:08". Some may be of a ring of the same name that ran
/// before and was not taken down. Empty if there are none.
std::string ended_lives(const std::string& ring_folder, const std::string& folder) {
  std::string lines;
  for (const std::string& file : recorder::recordings_in(folder)) lines += ended_life(ring_folder, file);
  return lines;
}

namespace fs = std::filesystem;

struct RecordOptions {
  std::string folder;
  std::vector<std::string> when{"crash", "break", "promise"};
  unsigned keep = 5;
};

/// A ring that is being started may take so long until one of its daemons answers.
constexpr std::chrono::seconds kStarts{60};

/// The only ring with recordings, if none is named: also one whose daemons are all dead.
std::string recorded_ring(const std::string& given) {
  const std::string named = named_ring(given);
  if (!named.empty()) return named;
  std::vector<std::string> rings;
  std::error_code error;
  for (fs::directory_iterator it(rings_directory(), error), end; !error && it != end; it.increment(error))
    if (!recorder::recordings_in(it->path().string()).empty()) rings.push_back(it->path().filename().string());
  if (rings.size() == 1) return rings.front();
  if (rings.empty())
    throw NoRing("no ring has recordings; 'ringctl up --record' or recorder: {enabled: true} makes them");
  std::string names;
  for (const std::string& ring : rings) names += ' ' + ring;
  throw UsageError("which ring? --ring one of" + names);
}

void require_recordings(const std::string& ring) {
  if (!recorder::recordings_in(ring_directory(ring)).empty()) return;
  throw NoRing("ring " + ring + " has no recordings; 'ringctl up --record' or recorder: {enabled: true} makes them");
}

/// Now, since nobody looks when something goes wrong later.
void require_writable(const fs::path& folder) {
  const std::string problem = app::make_output_folder(folder.string());
  if (!problem.empty()) throw UsageError(problem);
}

void require_empty(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw NotDone("cannot make " + folder.string() + ": " + error.message());
  if (!fs::is_empty(folder, error) || error)
    throw UsageError(folder.string() + " is not empty; a folder of its own is needed");
}

int save(const RecordOptions& options, const Context& context) {
  tell_unreadable_rings();
  const std::string ring = recorded_ring(context.ring);
  require_recordings(ring);
  require_empty(options.folder);
  const recorder::SavedRing saved = recorder::save_ring(ring_directory(ring), options.folder);
  const std::string ended = ended_lives(ring_directory(ring), options.folder);
  if (saved.recordings != 0)
    std::cout << "saved " << app::counted(saved.recordings, "recording") << " of ring " << ring << ", "
              << saved.bytes / 1000 << " kB; 'ringctl record check " << options.folder << "' does it all again\n"
              << (ended.empty() ? "" : "of lives that have ended:\n") << ended << std::flush;
  if (!saved.problems.empty()) throw NotDone("not saved: " + config::join(saved.problems, "; "));
  return kDone;
}

/// @throw NoRing if none answers in time
RingAccess wait_for_ring(const std::string& ring, process::SignalWait& signals) {
  const auto deadline = std::chrono::steady_clock::now() + kStarts;
  for (;;) {
    try {
      return RingAccess::open(ring);
    } catch (const NoRing&) {
      if (std::chrono::steady_clock::now() >= deadline || signals.asked_to_end(process::SignalWait::kTick)) throw;
    }
  }
}

int keep(const RecordOptions& options, const Context& context) {
  process::SignalWait signals;
  const RingAccess ring = wait_for_ring(choose_ring(context.ring), signals);
  require_recordings(ring.ring());
  const std::string folder = fs::absolute(options.folder).lexically_normal().string();
  require_writable(folder);
  RecordingKeeper keeper(ring, {{options.when.begin(), options.when.end()}, folder, options.keep});
  keeper.poll();
  tell_user("recordings of ring " + ring.ring() + " are saved in " + folder + " when something goes wrong");
  do keeper.poll();
  while (!signals.asked_to_end(RecordingKeeper::kRound) && !keeper.ring_is_gone());
  return kDone;
}

void add_keep(CLI::App& record, Context& context) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App* command =
      add_command(record, "keep", "Save the recordings each time something goes wrong",
                  "ringctl record keep saves --when crash,promise",
                  "Runs until the ring is taken down. 'ringctl up' does the same if the ring's file says recorder: "
                  "{save: ...}.");
  command->add_option("DIR", options->folder, "Each save is a folder in it, named by ring, date and reason")
      ->required();
  command->add_option("--when", options->when, "crash, break, promise; default: all of them")
      ->delimiter(',')
      ->transform(cli::one_of({"crash", "break", "promise"}));
  command->add_option("--keep", options->keep, "How many saves of the ring to keep, the newest; 1 to 1000, default 5")
      ->transform(cli::whole(1, 1000));
  command->callback([&context, options] { context.action = [options, &context] { return keep(*options, context); }; });
}

void add_save(CLI::App& record, Context& context) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App* command =
      add_command(record, "save", "Copy the recordings of all nodes", "ringctl record save what-happened",
                  "Includes dead nodes, and earlier runs of a node. The ring goes on. Save before 'ringctl down', "
                  "which removes the recordings.");
  command->add_option("DIR", options->folder, "A new or empty folder")->required();
  command->callback([&context, options] { context.action = [options, &context] { return save(*options, context); }; });
}

using recorder::ReplayedLife;
using recorder::ReplayedRing;

struct CheckOptions {
  std::string folder;
  std::optional<std::int64_t> until_ns;
  std::string node;
  bool print = false;
  std::string capture;
};

std::string seconds(std::chrono::nanoseconds time) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(9) << std::chrono::duration<double>(time).count() << " s";
  return text.str();
}

std::string name_of(const ReplayedLife& life) {
  const char* which = recorder::is_of_former_life(life.file()) ? ", the life before)" : ")";
  return "node " + std::to_string(life.node()) + " (" + life.title().node + which;
}

bool is_of(const ReplayedLife& life, const std::string& node) {
  return node == life.title().node || node == std::to_string(life.node());
}

void print_difference(const ReplayedRing& ring, ReplayedLife& life) {
  const recorder::Difference& difference = *life.replay().difference();
  std::cout << name_of(life) << ": differs " << seconds(ring.after(life.machine_time(difference.at)))
            << " after the first record, in " << difference.what << "\n  recorded  " << difference.recorded
            << "\n  replayed  " << difference.replayed << "\n";
}

void print_state(ReplayedLife& life) {
  const std::string state = recorder::describe_state(life.replay().controller());
  std::cout << name_of(life) << ", what is not as in a core that has just started:\n"
            << (state.empty() ? "nothing\n" : state);
}

/// @return how many lives differ
unsigned print_results(ReplayedRing& ring) {
  unsigned different = 0;
  std::uint64_t records = 0;
  for (const auto& life : ring.lives()) {
    records += life->replay().records();
    if (!life->replay().difference()) {
      std::cout << name_of(*life) << ": " << life->replay().records() << " records, identical\n";
      continue;
    }
    ++different;
    print_difference(ring, *life);
  }
  std::cout << ring.lives().size() << " lives of nodes, " << records
            << " records: " << (different == 0 ? "all identical" : std::to_string(different) + " differ") << std::endl;
  return different;
}

std::string name_of(const ReplayedRing& ring, std::uint8_t id) {
  for (const auto& life : ring.lives())
    if (life->node() == id) return "node " + std::to_string(id) + " (" + life->title().node + ")";
  return "node " + std::to_string(id);
}

void print_breach(const ReplayedRing& ring, const promises::Breach& breach) {
  std::cout << "promise broken " << seconds(ring.after(std::chrono::nanoseconds(breach.at_ns)))
            << " after the first record, at " << name_of(ring, breach.node) << ": " << to_string(breach.promise) << ": "
            << breach.what << "\n";
}

void print_promises(const ReplayedRing& ring, const recorder::ReplayedPromises& promises) {
  for (const promises::Breach& breach : promises.breaches()) print_breach(ring, breach);
  const std::uint64_t broken = promises.counts().breaches;
  std::cout << "promises: " << (broken == 0 ? "all kept" : std::to_string(broken) + " broken") << "; "
            << describe(promises.counts()) << std::endl;
}

void require_node(ReplayedRing& ring, const std::string& node) {
  for (const auto& life : ring.lives())
    if (is_of(*life, node)) return;
  throw UsageError("--node " + node + ": there is no recording of it");
}

void require_no_recording(ReplayedRing& ring, const std::string& capture) {
  for (const auto& life : ring.lives())
    if (app::is_same_file(life->file(), capture))
      throw UsageError("--capture names a recording: " + capture + " would be lost; write to another file");
}

int check(const CheckOptions& options) {
  if (options.print && options.node.empty()) throw UsageError("--print goes with --node: all records of one node");
  if (!options.node.empty() && !options.print && !options.until_ns)
    throw UsageError("--node goes with --until, for its state, or with --print, for its records");
  std::unique_ptr<ReplayedRing> ring;
  try {
    ring = std::make_unique<ReplayedRing>(options.folder);
  } catch (const std::runtime_error& problem) {
    throw UsageError(problem.what());
  }
  if (!options.node.empty()) require_node(*ring, options.node);
  require_no_recording(*ring, options.capture);
  std::ofstream file;
  std::optional<recorder::ReplayCapture> capture;
  if (!options.capture.empty()) {
    const std::string problem = app::open_for_writing(file, options.capture);
    if (!problem.empty()) throw UsageError("--capture " + problem);
    capture.emplace(*ring, file);
  }
  const std::chrono::nanoseconds until(options.until_ns.value_or(std::numeric_limits<std::int64_t>::max() / 2));
  recorder::ReplayedPromises promises(*ring);
  Progress progress;
  std::uint64_t done = 0;
  while (ReplayedLife* life = ring->step(until)) {
    promises.has_done(*life);
    if (++done % 4096 == 0) progress.tell("replayed " + std::to_string(done) + " records");
    if (!options.print || !is_of(*life, options.node)) continue;
    const recorder::Record& record = life->replay().last();
    std::cout << seconds(ring->after(life->machine_time(record.at))) << "  " << recorder::describe(record) << '\n';
  }
  if (options.until_ns)
    for (const auto& life : ring->lives())
      if (options.node.empty() || is_of(*life, options.node)) print_state(*life);
  promises.finish();
  print_promises(*ring, promises);
  const unsigned different = print_results(*ring);
  if (capture) {
    const std::string problem = cli::finish_writing(file, options.capture);
    if (!problem.empty()) throw std::runtime_error(problem);
  }
  return different == 0 && promises.counts().breaches == 0 ? kDone : kNotDone;
}

void add_record_check(CLI::App& app, Context& context) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command =
      add_command(app, "check", "Replay saved recordings, and judge the promises", "ringctl record check what-happened",
                  "Compares each byte and each event with what was recorded, and judges the promises over all "
                  "nodes. Exits with 1 if this program behaves differently, or if a promise was broken.");
  command->add_option("DIR", options->folder, "Folder of 'ringctl record save'")->required();
  command->add_option("--until", options->until_ns, "Stop N seconds after the first record, and print the state")
      ->transform(cli::nanoseconds(std::chrono::nanoseconds(0), std::chrono::seconds(1'000'000'000)));
  command->add_option("--node", options->node, "Print state or records (--print) of only this node, id or name");
  command->add_flag("--print", options->print, "Print each record of --node, a line each");
  command->add_option("--capture", options->capture,
                      "Write the packets on all lines there, as pcapng: for 'ringctl traffic why' and Wireshark");
  command->callback([&context, options] { context.action = [options] { return check(*options); }; });
}

}  // namespace

void add_record(CLI::App& app, Context& context) {
  CLI::App& record =
      add_group(app, "record", "Save and check what the flight recorders wrote", "ringctl record save what-happened");
  add_save(record, context);
  add_keep(record, context);
  add_record_check(record, context);
  add_record_cause(record, context);
}

}  // namespace limb_ring::ringctl
