#include <CLI/CLI.hpp>
#include <iostream>
#include <limits>
#include <memory>

#include "study/shrunk_soak.h"
#include "tools/common/command_line.h"
#include "tools/common/ring_file.h"
#include "tools/ring_sim/command_line.h"

namespace limb_ring::ring_sim {

namespace {

struct CauseOptions {
  std::uint64_t seed = 0;
  study::FoldingRings folding = study::FoldingRings::some;
  std::string out;
};

void write_needed(const study::RandomFaults& run, const CauseOptions& options, const scenario::Cause& cause) {
  std::vector<std::size_t> events;
  for (const scenario::Cause::Needed& needed : cause.needed) events.push_back(needed.event);
  const std::string problem = app::write_file(options.out, study::scenario_of(run, options.seed, events));
  if (!problem.empty()) throw UsageError("--out: " + problem);
  std::cout << "These events alone: ringctl scenario run " << app::shell_word(options.out) << '\n';
}

int find_cause(const CauseOptions& options) {
  study::RandomFaults run(options.seed, options.folding);
  run.keep_history();
  run.run();
  std::cout << "seed " << options.seed << ": " << run.describe() << '\n';
  if (!run.violation()) {
    std::cerr << "ring_sim: this seed breaks no promise: there is no cause to find\n";
    return kBroken;
  }
  std::cout << "promise broken: " << to_string(run.violation()->promise) << ": " << run.violation()->what() << '\n';
  const auto story = study::story_of(run, options.seed, options.folding);
  if (!story) {
    std::cerr << "ring_sim: as a scenario it does not fail: only the seed shows it\n";
    return kBroken;
  }
  Progress progress;
  const auto cause = scenario::cause_of(
      *story, [&progress](std::size_t runs) { progress.tell("the cause: " + std::to_string(runs) + " runs"); });
  std::cout << text_of(cause, *story);
  if (!options.out.empty()) write_needed(run, options, cause);
  return kDone;
}

}  // namespace

void add_cause(CLI::App& app, Context& context) {
  auto options = std::make_shared<CauseOptions>();
  CLI::App* command = add_command(
      app, "cause", "Say which event makes a seed of soak fail, and what would save it", "ring_sim cause 4711",
      "Runs the seed again with fewer events, and with other futures from each of them on. Only in soak's usual world. "
      "Ends with 1 if the seed breaks no promise.");
  command->add_option("SEED", options->seed, "The seed, above 0")
      ->required()
      ->transform(cli::whole(1, std::numeric_limits<std::int64_t>::max()));
  add_folding(*command, options->folding, "mixed (default) or foldback, as of ring_sim soak");
  command->add_option("-o,--out", options->out, "Write the story with the needed events alone there, as a scenario");
  command->callback([&context, options] { context.action = [options] { return find_cause(*options); }; });
}

}  // namespace limb_ring::ring_sim
