#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "app/common/out_file.h"
#include "app/common/text_table.h"
#include "app/ringctl/choose_ring.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/recording_keeper.h"
#include "app/ringctl/ring_access.h"
#include "app/ringctl/ring_folder.h"
#include "app/ringctl/saved_lives.h"
#include "app/ringctl/tell_user.h"
#include "cli/values.h"
#include "config/names.h"
#include "limb_ring/ring_directory.h"
#include "process/signal_wait.h"
#include "recorder/recorder_file.h"
#include "recorder/save_ring.h"

namespace limb_ring::ringctl {

namespace {

namespace fs = std::filesystem;

struct RecordOptions {
  std::string folder;
  std::vector<std::string> when{"crash", "break", "promise"};
  unsigned keep = 5;
};

/// A ring that is being started may take so long until one of its daemons answers.
constexpr std::chrono::seconds kStarts{60};

/// The only ring with recordings, where none is named: also one whose daemons are all dead.
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
              << saved.bytes / 1000 << " kB; 'ring_sim replay " << options.folder << "' does it all again\n"
              << (ended.empty() ? "" : "of lives that have ended:\n") << ended << std::flush;
  if (!saved.problems.empty()) throw NotDone("not saved: " + config::join(saved.problems, "; "));
  return kDone;
}

/// @throw NoRing where none answers in time
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

void add_keep(CLI::App& record, Context& context, const std::shared_ptr<RecordOptions>& options) {
  CLI::App* command = add_command(record, "keep",
                                  "Stay beside the ring and save its recordings when something goes wrong, until it is "
                                  "taken down; 'ringctl up' does it where the ring's file says recorder: {save: ...}");
  command->add_option("DIR", options->folder, "Each save is a folder in it, named by ring, date and reason")
      ->required();
  command->add_option("--when", options->when, "crash, break, promise; default: all of them")
      ->delimiter(',')
      ->transform(cli::one_of({"crash", "break", "promise"}));
  command->add_option("--keep", options->keep, "So many saves of the ring, the newest; 1 to 1000, default 5")
      ->transform(cli::whole(1, 1000));
  command->callback([&context, options] { context.action = [options, &context] { return keep(*options, context); }; });
}

}  // namespace

void add_record(CLI::App& app, Context& context) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App* record = add_command(app, "record", "What the nodes' flight recorders have written");
  record->require_subcommand(1);
  CLI::App* command = add_command(*record, "save",
                                  "Copy the recordings of all nodes, also of dead ones and of the lives before, while "
                                  "the ring goes on; before 'ringctl down', which removes them");
  command->add_option("DIR", options->folder, "A new or empty folder")->required();
  command->callback([&context, options] { context.action = [options, &context] { return save(*options, context); }; });
  add_keep(*record, context, std::make_shared<RecordOptions>());
}

}  // namespace limb_ring::ringctl
