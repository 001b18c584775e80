#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "app/common/text_table.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "limb_ring/ring_directory.h"
#include "recorder/recorder_file.h"

namespace limb_ring::ringctl {

namespace {

namespace fs = std::filesystem;

struct RecordOptions {
  std::string folder;
  std::string ring;
};

/// The only ring with recordings, where none is named: also one whose daemons are all dead.
std::string recorded_ring(const std::string& asked) {
  if (!asked.empty()) return asked;
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

void require_empty(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw NotDone("cannot make " + folder.string() + ": " + error.message());
  if (!fs::is_empty(folder, error) || error)
    throw UsageError(folder.string() + " is not empty; a folder of its own is needed");
}

int save(const RecordOptions& options, const Context& context) {
  const std::string ring = recorded_ring(context.ring);
  const std::vector<std::string> recordings = recorder::recordings_in(ring_directory(ring));
  if (recordings.empty())
    throw NoRing("ring " + ring + " has no recordings; 'ringctl up --record' or recorder: {enabled: true} makes them");
  require_empty(options.folder);
  std::size_t bytes = 0;
  for (const std::string& recording : recordings) {
    try {
      bytes += recorder::save_file(recording, (fs::path(options.folder) / fs::path(recording).filename()).string());
    } catch (const std::exception& problem) {
      throw NotDone(recording + ": " + problem.what());
    }
  }
  std::cout << "saved " << app::counted(recordings.size(), "recording") << " of ring " << ring << ", " << bytes / 1000
            << " kB; 'ring_sim replay " << options.folder << "' does it all again" << std::endl;
  return kDone;
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
}

}  // namespace limb_ring::ringctl
