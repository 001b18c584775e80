#include <fstream>
#include <iomanip>
#include <iostream>
#include <limits>
#include <memory>
#include <sstream>

#include "app/common/out_file.h"
#include "app/ring_sim/commands.h"
#include "app/ring_sim/problems.h"
#include "app/ring_sim/progress.h"
#include "cli/output.h"
#include "cli/values.h"
#include "recorder/recorder_file.h"
#include "recorder/replay_capture.h"
#include "recorder/replayed_promises.h"
#include "recorder/replayed_ring.h"

namespace limb_ring::ring_sim {

namespace {

using recorder::ReplayedLife;
using recorder::ReplayedRing;
using std::chrono::nanoseconds;

struct ReplayOptions {
  std::string folder;
  std::optional<std::int64_t> until_ns;
  std::string node;
  bool print = false;
  std::string capture;
};

std::string seconds(nanoseconds time) {
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
  std::cout << "promise broken " << seconds(ring.after(nanoseconds(breach.at_ns))) << " after the first record, at "
            << name_of(ring, breach.node) << ": " << to_string(breach.promise) << ": " << breach.what << "\n";
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

int run(const ReplayOptions& options) {
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
  const nanoseconds until(options.until_ns.value_or(std::numeric_limits<std::int64_t>::max() / 2));
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
  return different == 0 && promises.counts().breaches == 0 ? kDone : kBroken;
}

}  // namespace

void add_replay(CLI::App& app, Context& context) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command =
      add_command(app, "replay",
                  "Do again what flight recorders of a live ring have recorded, compare each byte and "
                  "event, and judge the ring's promises over all nodes together; exit code 1 where this "
                  "program does something else, or a promise was broken");
  command->add_option("DIR", options->folder, "Folder of 'ringctl record save'")->required();
  command->add_option("--until", options->until_ns, "Stop so many seconds after the first record, and print the state")
      ->transform(cli::nanoseconds(nanoseconds(0), std::chrono::seconds(1'000'000'000)));
  command->add_option("--node", options->node, "Print the state, or --print, of this node alone: id or name");
  command->add_flag("--print", options->print, "Each record of --node in a line");
  command->add_option("--capture", options->capture,
                      "Write the packets on all lines there, as pcapng: for 'ringctl trace' and Wireshark");
  command->callback([&context, options] { context.action = [options] { return run(*options); }; });
}

}  // namespace limb_ring::ring_sim
