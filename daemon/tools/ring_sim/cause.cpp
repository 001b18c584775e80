#include <CLI/CLI.hpp>
#include <iostream>
#include <limits>
#include <memory>

#include "sim/load_scenario.h"
#include "study/shrunk_soak.h"
#include "tools/common/command_line.h"
#include "tools/common/ring_file.h"
#include "tools/ring_sim/command_line.h"

namespace limb_ring::ring_sim {

namespace {

struct CauseOptions {
  study::RandomFaults::Origin origin{};
  std::string out;
};

/// @throw UsageError
void check(const CauseOptions& options) {
  const auto& more = options.origin.more;
  const bool usual = world_for(more.sought, options.origin.world) == study::WorldKind::usual;
  if (!options.out.empty() && !(usual && more.drift == 0 && more.sought == nullptr))
    throw UsageError(
        "--out goes only with seeds of the usual world that have neither --drift nor --seek: no scenario has the rest. "
        "Without it the cause is printed all the same");
}

void write_needed(const study::RandomFaults& run, const CauseOptions& options, const scenario::Cause& cause) {
  std::vector<std::size_t> events;
  for (const scenario::Cause::Needed& needed : cause.needed) events.push_back(needed.event);
  const std::string text = study::scenario_of(run, events);
  const std::string problem = app::write_file(options.out, text);
  if (!problem.empty()) throw UsageError("--out: " + problem);
  const auto told = run_scenario(scenario::parse_scenario(text, options.out), options.origin.seed);
  std::cout << "These events alone: ringctl scenario run " << app::shell_word(options.out)
            << (told.unmet ? "" : " (as a scenario they do not fail: only the seed shows it)") << '\n';
}

int find_cause(const CauseOptions& options) {
  check(options);
  study::RandomFaults::Origin origin = options.origin;
  origin.world = world_for(origin.more.sought, origin.world);
  study::RandomFaults run(origin);
  run.keep_history();
  run.run();
  std::cout << "seed " << origin.seed << ": " << run.describe() << '\n';
  if (!run.violation()) {
    std::cerr << "ring_sim: this seed breaks no promise: there is no cause to find\n";
    return kBroken;
  }
  std::cout << "promise broken: " << to_string(run.violation()->promise) << ": " << run.violation()->what() << '\n';
  const auto story = study::story_of(run);
  if (!story) {
    std::cerr << "ring_sim: the same events, done once more, do not fail: only the seed shows it\n";
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
      "Runs the seed again with fewer events, and with other futures from each of them on. Takes the options that soak "
      "prints behind 'again with'. Ends with 1 if the seed breaks no promise.");
  command->add_option("SEED", options->origin.seed, "The seed, above 0")
      ->required()
      ->transform(cli::whole(1, std::numeric_limits<std::int64_t>::max()));
  add_folding(*command, options->origin.fold_back, "mixed (default) or foldback, as of ring_sim soak");
  add_world(*command, options->origin.world, options->origin.more);
  command->add_option_function<std::string>(
      "--seek", [options](const std::string& name) { options->origin.more.sought = &sim::goals()[read_goal(name)]; },
      "The goal that the seed has sought");
  command->add_option("-o,--out", options->out,
                      "Write the story with the needed events alone there, as a scenario; of the usual world only");
  command->callback([&context, options] { context.action = [options] { return find_cause(*options); }; });
}

}  // namespace limb_ring::ring_sim
