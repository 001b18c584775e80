#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>

#include "core/time.h"
#include "io/signal_wait.h"
#include "sim/trace.h"
#include "study/exploration.h"
#include "tools/common/command_line.h"
#include "tools/ring_sim/command_line.h"

namespace limb_ring::ring_sim {

namespace {

struct ExploreOptions {
  study::World world;
  study::Exploration::Bounds bounds;
  bool all_runs = false;            ///< no state is recognised
  std::optional<std::string> only;  ///< the strikes of one run
  app::Format format = app::Format::text;
};

constexpr const char* kNoStrikes = "none";  // of --only

std::string arguments(const ExploreOptions& options) {
  const study::World& world = options.world;
  return "--nodes " + std::to_string(world.nodes) + " --sends " + std::to_string(world.sends) +
         (world.paced ? "" : " --rate unlimited") + (world.fold_back ? " --redundancy foldback" : "") +
         (world.broken ? " --open-chain" : "");
}

std::string violation_text(const ExploreOptions& options, const std::vector<study::Choice>& choices,
                           const sim::Violation& broken) {
  const std::string only = choices.empty() ? kNoStrikes : study::to_text(choices);
  return std::string("promise broken: ") + to_string(broken.promise) + "\nat " +
         std::to_string(core::picoseconds(broken.at.time_since_epoch())) + " ps: " + broken.what() +
         "\nagain with: ring_sim explore " + arguments(options) + " --only " + only + "\n";
}

/// The strikes of --only; every node in them is one of the ring.
std::vector<study::Choice> choices_of(const ExploreOptions& options) {
  if (*options.only == kNoStrikes) return {};
  try {
    const std::vector<study::Choice> choices = study::choices_from(*options.only);
    for (const study::Choice& choice : choices)
      if (choice.strike.node >= options.world.nodes)
        throw std::invalid_argument("there is no node " + std::to_string(choice.strike.node) + ", only 0 to " +
                                    std::to_string(options.world.nodes - 1));
    return choices;
  } catch (const std::invalid_argument& problem) {
    throw UsageError(std::string("--only: ") + problem.what());
  }
}

int run_one(const ExploreOptions& options) {
  const std::vector<study::Choice> choices = choices_of(options);
  study::ExploredRun run(options.world, choices);
  sim::Trace trace(run.ring());
  run.run();
  if (run.violation()) {
    std::cerr << violation_text(options, choices, *run.violation());
    return kBroken;
  }
  for (const study::Choice& choice : choices)
    if (choice.place >= run.places())
      throw UsageError("--only: there is no place " + std::to_string(choice.place) + ", only 0 to " +
                       std::to_string(run.places() - 1));
  app::Row row{{"places", run.places()}, {"trace", sim::hash_text(trace.hash())}};
  std::cout << app::format_rows({row}, options.format);
  if (options.format == app::Format::text) std::cout << "No promise was broken.\n";
  return kDone;
}

std::string exhausted_text(const study::Exploration::Bounds& bounds) {
  const std::string most = bounds.faults == 0   ? "no fault"
                           : bounds.faults == 1 ? "at most one fault"
                                                : "at most " + std::to_string(bounds.faults) + " faults";
  const std::string where = bounds.faults == 0 ? ""
                            : bounds.places < study::Exploration::kAllPlaces
                                ? ", each at one of the first " + std::to_string(bounds.places) + " places"
                                : ", each at any place";
  return "Exhausted: all runs with " + most + where + ". No promise was broken.\n";
}

int run_all(const ExploreOptions& options) {
  const study::Exploration::Bounds& bounds = options.bounds;
  study::Exploration exploration(options.world, bounds);
  Progress progress;
  process::SignalWait signals;  // made before the threads, so that they leave Ctrl-C to it
  bool interrupted = false;
  exploration.run([&] {
    interrupted = interrupted || signals.asked_to_end(std::chrono::milliseconds(0));
    if (interrupted) exploration.stop();
    progress.tell(std::to_string(exploration.runs()) + " runs, " + std::to_string(exploration.recognised()) +
                  " of them into a state met before, no promise broken");
  });
  if (const auto& found = exploration.found()) {
    std::cerr << violation_text(options, found->choices, found->violation);
    return kBroken;
  }
  const app::Row row{{"nodes", options.world.nodes},
                     {"sends", options.world.sends},
                     {"faults", bounds.faults},
                     {"places", std::min(exploration.places(), bounds.places)},
                     {"runs", exploration.runs()},
                     {"states", exploration.states()},
                     {"recognised", exploration.recognised()}};
  std::cout << app::format_rows({row}, options.format);
  if (options.format == app::Format::text && !interrupted) std::cout << exhausted_text(bounds);
  if (!interrupted) return kDone;
  std::cerr << "ring_sim: interrupted: no promise was broken so far, but not all was run\n";
  return kBroken;
}

constexpr const char* kExploreHelp =
    "A place is one slice that leaves a node, from the first send until all sends have ended and the ring is whole "
    "again. At a place one of these faults may strike: the slice is lost, damaged in its first, middle or last byte, "
    "late, or doubled (not with fold-back); a node restarts, or is frozen for 3 ms; a line is cut for 3 ms. An INTP "
    "that a node sends at a place counts like a fault. At least one slice leaves between two faults.\n"
    "A run ends early if it reaches a state that another run has reached, because both would go on alike. States are "
    "compared by a hash of 64 bits: after every slice as long as another fault may strike, and when all sends have "
    "ended.";

void add_size(CLI::App& command, study::World& world) {
  command.add_option("--nodes", world.nodes, "Nodes of the ring, 2 to 6; default 3")->transform(cli::whole(2, 6));
  command
      .add_option("--sends", world.sends, "Sends asked for at once, DATPs and broadcasts by turns, 1 to 6; default 2")
      ->transform(cli::whole(1, 6));
}

void add_bounds(CLI::App& command, ExploreOptions& options) {
  study::Exploration::Bounds& bounds = options.bounds;
  command
      .add_option("--faults", bounds.faults,
                  "At most N faults in a run, 0 to 3; default 1. Each more takes some hundred times as long")
      ->transform(cli::whole(0, 3));
  command
      .add_option("--places", bounds.places,
                  "Faults strike only at the first N places of a run, 1 to 1000000; default: at all")
      ->transform(cli::whole(1, study::Exploration::kAllPlaces));
  command.add_flag("--all-runs", options.all_runs,
                   "Run each to its end, also if another run has reached the same state");
  bounds.threads = std::max(1u, std::thread::hardware_concurrency());
  command
      .add_option(
          "--threads", bounds.threads,
          "Runs at once, 1 to 256; default: one per CPU. With 1, it is always the same run that is printed for a "
          "broken promise")
      ->transform(cli::whole(1, 256));
}

void add_line_options(CLI::App& command, study::World& world) {
  command
      .add_option_function<std::string>(
          "--rate", [&world](const std::string& rate) { world.paced = rate == "1Gbit/s"; },
          "Rate of the lines. 1Gbit/s (default): packets leave in slices. unlimited: they leave whole")
      ->transform(cli::one_of({"1Gbit/s", "unlimited"}));
  command
      .add_option_function<std::string>(
          "--redundancy", [&world](const std::string& what) { world.fold_back = what == "foldback"; },
          "none (default), or foldback: a second line; a fault then cuts both lines of a cable")
      ->transform(cli::one_of({"none", "foldback"}));
  command.add_flag(
      "--open-chain", world.broken,
      "Cut the line out of the last node before the sends, and mend it at the end; with fold-back its cable, so "
      "that the ring is folded");
}

int run(ExploreOptions& options) {
  options.bounds.recognise = !options.all_runs;
  return options.only ? run_one(options) : run_all(options);
}

}  // namespace

void add_explore(CLI::App& app, Context& context) {
  auto options = std::make_shared<ExploreOptions>();
  CLI::App* command = add_command(app, "explore", "Check all promises under every fault at every place",
                                  "ring_sim explore --nodes 3 --faults 2", kExploreHelp);
  add_size(*command, options->world);
  add_bounds(*command, *options);
  add_line_options(*command, options->world);
  CLI::Option* only = command->add_option("--only", options->only,
                                          "Make only one run, with these faults: 12:lost,20:restart:1; or none");
  for (const char* of_many : {"--faults", "--places", "--threads", "--all-runs"}) only->excludes(of_many);
  add_format(*command, options->format);
  command->callback([&context, options] { context.action = [options] { return run(*options); }; });
}

}  // namespace limb_ring::ring_sim
