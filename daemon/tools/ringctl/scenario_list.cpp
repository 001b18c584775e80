#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <sstream>

#include "io/signal_wait.h"
#include "node/program_stage.h"
#include "sim/load_scenario.h"
#include "sim/scenario_cause.h"
#include "sim/scenario_report.h"
#include "sim/scenario_shrink.h"
#include "tools/common/command_line.h"
#include "tools/common/picture_page.h"
#include "tools/common/ring_file.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/cause_page.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/play.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
namespace {

namespace fs = std::filesystem;

struct ScenarioListOptions {
  std::vector<std::string> places;
  bool as_json = false;
};

/// A file that was not meant as a scenario, or one with a mistake: the error text says which.
struct NoScenario {
  std::string file, why;
};

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".yaml" || entry.path().extension() == ".yml")
      files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

app::Row row_of(const std::string& file, bool as_json) {
  const auto scenario = scenario::load_scenario(file);
  const auto not_live = only_virtual(scenario, "");
  const auto not_virtual = program_stage::not_with_programs(scenario);
  const std::string where =
      std::string("sim") + (not_virtual.empty() ? ", virtual" : "") + (not_live.empty() ? ", live" : "");
  app::Row row{{"file", fs::path(file).filename().string()},
               {"where", where == "sim" ? "sim only" : where},
               {"scenario", scenario.name + (expects_something(scenario) ? "" : " (expects nothing)")}};
  if (as_json) row["why_not_live"] = not_live;
  if (as_json) row["why_not_virtual"] = not_virtual;
  return row;
}

/// Adds all scenarios of a folder. Other files there are only named.
void add_folder(const std::string& folder, bool as_json, std::vector<app::Row>& rows, std::vector<NoScenario>& others) {
  const std::size_t before = rows.size() + others.size();
  for (const std::string& file : files_in(folder)) {
    try {
      rows.push_back(row_of(file, as_json));
    } catch (const config::ConfigError& error) {
      others.push_back({file, error.what()});
    }
  }
  if (rows.size() + others.size() == before) throw UsageError(folder + ": no scenario there (*.yaml)");
}

int run(const ScenarioListOptions& options) {
  std::vector<app::Row> rows;
  std::vector<NoScenario> others;
  for (const std::string& place : options.places) {
    if (fs::is_directory(place))
      add_folder(place, options.as_json, rows, others);
    else
      rows.push_back(row_of(place, options.as_json));
  }
  std::cout << app::format_rows(rows, options.as_json ? app::Format::json : app::Format::text);
  if (options.as_json) std::cout << '\n';
  for (const NoScenario& other : others) std::cerr << "not a scenario: " << other.why << '\n';
  return kDone;
}

}  // namespace

void add_scenario_list(CLI::App& scenario, Context& context) {
  auto options = std::make_shared<ScenarioListOptions>();
  CLI::App* command = add_command(scenario, "list", "Show what scenarios are about, and where they run",
                                  "ringctl scenario list scenarios/");
  command->add_option("PLACE", options->places, "Scenarios, or folders of them")->required();
  add_json(*command, options->as_json);
  command->callback([&context, options] { context.action = [options] { return run(*options); }; });
}

// ---- searches in a scenario that fails ------------------------------------------------------

namespace {

[[noreturn]] void nothing_to_find(const std::string& path) {
  throw NotDone(path + " is as expected under the virtual clock: there is nothing to find");
}

/// Adds --seed, and what the command does.
void add_search(CLI::App& command, Context& context, std::optional<std::uint64_t>& seed, std::function<int()> search) {
  command.add_option("--seed", seed, "Instead of the file's own")
      ->transform(cli::whole(0, std::numeric_limits<std::int64_t>::max()));
  command.callback([&context, search = std::move(search)] {
    if (!context.ring.empty()) throw CLI::ValidationError("--ring", "a scenario has a ring of its own");
    context.action = search;
  });
}

struct ShrinkOptions {
  scenario::ShrinkRequest request;
  std::string out;
};

void write(const std::string& text, const std::string& path) {
  if (path.empty()) {
    std::cout << text;
    return;
  }
  const std::string problem = app::write_file(path, text);
  if (!problem.empty()) throw NotDone(problem);
}

/// Now, since the small scenario may come after minutes. @throw UsageError
void require_writable(const std::string& path) {
  const std::string problem = path.empty() ? "" : app::why_not_writable(path);
  if (!problem.empty()) throw UsageError("--out " + problem);
}

int run(ShrinkOptions& options) {
  if (app::is_same_file(options.request.path, options.out))
    throw UsageError("--out names the scenario itself: " + options.out + " would be lost; write to another file");
  require_writable(options.out);
  if (!options.out.empty()) options.request.beside = std::filesystem::absolute(options.out).parent_path().string();
  Progress progress;
  options.request.tell = [&progress](std::size_t runs) {
    progress.tell("the smallest scenario: " + std::to_string(runs) + " tried");
  };
  const auto shrunk = scenario::shrink(options.request);
  if (!shrunk) nothing_to_find(options.request.path);
  write(shrunk->text, options.out);
  std::cerr << text_of(shrunk->run) << "\n"
            << in_words(shrunk->before) << " before, " << in_words(shrunk->after) << " now; " << shrunk->runs
            << " tried" << (shrunk->stopped ? ", and no more: it may not be the smallest" : "") << std::endl;
  return kDone;
}

}  // namespace

void add_scenario_shrink(CLI::App& scenario, Context& context) {
  auto options = std::make_shared<ShrinkOptions>();
  CLI::App* command = add_command(scenario, "shrink", "Make a failing scenario as small as possible",
                                  "ringctl scenario shrink walk.yaml",
                                  "Uses the virtual clock. Ends with 1 if the scenario does not fail.");
  command->add_option("FILE", options->request.path, "The scenario, YAML")->required();
  command->add_option("-o,--out", options->out, "Write the small one there instead of to standard output");
  add_search(*command, context, options->request.seed, [options] { return run(*options); });
}

namespace {

struct CauseOptions {
  std::string path, html;
  std::optional<std::uint64_t> seed;
  bool with_programs = false;
};

/// Runs as asked for, until Ctrl-C. @param not_repeatable gets why another run of the same may differ
scenario::Runner runner_of(const CauseOptions& options, const process::SignalWait& signals,
                           std::string& not_repeatable) {
  return [&options, &signals, &not_repeatable](const scenario::Scenario& scenario, std::uint64_t seed,
                                               std::ostream* capture) {
    throw_if_interrupted(signals);
    if (!options.with_programs) return scenario::run_scenario(scenario, seed, capture);
    VirtualPlay play;
    play.capture = capture;
    scenario::ScenarioRun run = play_virtual(scenario, seed, play, signals);
    if (not_repeatable.empty()) not_repeatable = run.trace->not_repeatable;
    return run;
  };
}

int run(const CauseOptions& options) {
  const auto scenario = scenario::load_scenario(options.path);
  if (options.with_programs) require_virtual(scenario, {});
  std::ofstream html;
  std::string problem = options.html.empty() ? "" : app::open_for_writing(html, options.html);
  if (!problem.empty()) throw UsageError("--html " + problem);
  const std::uint64_t seed = options.seed.value_or(scenario.seed);
  std::string not_repeatable;
  const process::SignalWait signals;
  const scenario::Runner runner = runner_of(options, signals, not_repeatable);
  const auto story = scenario::story_of(scenario, seed, runner);
  if (!story) nothing_to_find(options.path);
  Progress progress;
  const auto cause = scenario::cause_of(
      *story, [&progress](std::size_t runs) { progress.tell("the cause: " + std::to_string(runs) + " runs"); });
  std::string text = text_of(cause, *story);
  if (!not_repeatable.empty())
    text += "Another search may find another cause: not repeatable: " + not_repeatable + '\n';
  std::cout << text;
  if (options.html.empty()) return kDone;
  std::stringstream captured;
  const scenario::ScenarioRun whole = runner(scenario, seed, &captured);
  app::write_states(html, scenario.name, captured, text + '\n' + text_of(whole) + '\n', whole.lasted,
                    marks_of(cause, *story));
  problem = cli::finish_writing(html, options.html);
  if (!problem.empty()) throw NotDone(problem);
  return kDone;
}

}  // namespace

std::vector<app::TimeMark> marks_of(const scenario::Cause& cause, const scenario::Story& story,
                                    std::chrono::nanoseconds from) {
  std::vector<app::TimeMark> marks;
  const auto add = [&](std::size_t event, const std::string& why) {
    marks.push_back({story.at(event) - from, std::to_string(event + 1), why + ": " + story.words(event)});
  };
  for (const auto& needed : cause.needed) add(needed.event, "needed");
  if (cause.sealed_by) add(*cause.sealed_by, "from here on every future fails");
  return marks;
}

void add_scenario_cause(CLI::App& scenario, Context& context) {
  auto options = std::make_shared<CauseOptions>();
  CLI::App* command = add_command(scenario, "cause", "Say which event makes a scenario fail, and what would save it",
                                  "ringctl scenario cause walk.yaml --virtual",
                                  "Under the virtual clock. Ends with 1 if the scenario does not fail.");
  command->add_option("FILE", options->path, "The scenario, YAML")->required();
  command->add_flag("--virtual", options->with_programs,
                    "With the programs of the ring's file as CPUs; default: with models of CPUs");
  command->add_option("--html", options->html,
                      "Write a page there: the states of each node over time, the events that count, and the cause");
  add_search(*command, context, options->seed, [options] { return run(*options); });
}

}  // namespace limb_ring::ringctl
