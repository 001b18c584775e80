#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>

#include "config/ring_config.h"
#include "io/signal_wait.h"
#include "sim/load_scenario.h"
#include "sim/scenario_report.h"
#include "tools/common/command_line.h"
#include "tools/common/picture_page.h"
#include "tools/common/ring_file.h"
#include "tools/common/text_table.h"
#include "tools/common/timeline.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/play.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
namespace {

app::Row results_of(const scenario::SendResults& send) {
  app::Row row{{"name", send.name}, {"taken", send.tally.taken}};
  for (std::size_t i = 0; i < send.tally.results.size(); ++i)
    row[to_string(static_cast<core::Outcome>(i))] = send.tally.results[i];
  row["worst_latency_ns"] = core::whole_nanoseconds(send.tally.worst).count();
  return row;
}

/// A scenario's run, as `scenario run --json` shows it.
app::Row row_of(const scenario::ScenarioRun& run) {
  app::Row row{{"file", run.path},
               {"scenario", run.name},
               {"seed", run.seed},
               {"order", run.order},
               {"met", !run.unmet.has_value()},
               {"clock", run.live ? "live" : "virtual"},
               {"lasted_ns", run.lasted.count()}};
  row["expected"] = run.unmet ? app::Row(run.unmet->expected) : app::Row();
  row["seen"] = run.unmet ? app::Row(run.unmet->seen) : app::Row();
  if (run.trace) {
    row["trace_hash"] = run.trace->hash;
    row["not_repeatable"] = run.trace->not_repeatable;
  }
  row["sends"] = app::Row::array();
  for (const auto& send : run.sends) row["sends"].push_back(results_of(send));
  row["log"] = app::Row::array();
  for (const auto& line : run.log) {
    row["log"].push_back({{"at_ns", line.at.count()}, {"what", line.what.words}});
    if (!line.what.event.empty()) row["log"].back().update({{"event", line.what.event}, {"node", line.what.node}});
  }
  return row;
}

using scenario::Scenario;
using scenario::ScenarioRun;

struct ScenarioOptions {
  std::vector<std::string> files;
  std::string junit, capture, perfetto, html;
  std::optional<std::uint64_t> seed;
  std::optional<std::uint32_t> order;
  std::uint32_t orders = 1;
  std::string transport, log;
  bool live = false, json = false, outputs = false;
  bool with_programs = false, scenario_cpus = false;  ///< under the virtual clock
};

void finish(std::ostream& out, const std::string& path) {
  const std::string problem = cli::finish_writing(out, path);
  if (!problem.empty()) throw NotDone(problem);
}

void require_none_of(const std::vector<std::string>& scenarios, const std::string& path) {
  for (const std::string& scenario : scenarios)
    if (app::is_same_file(scenario, path))
      throw UsageError(path + " is a scenario that is to be run, and would be lost; write to another file");
}

/// @throw UsageError if two options name one file: it would be neither
void require_files_of_their_own(const ScenarioOptions& options) {
  const std::pair<const char*, const std::string&> outputs[] = {{"--junit", options.junit},
                                                                {"--capture", options.capture},
                                                                {"--perfetto", options.perfetto},
                                                                {"--html", options.html},
                                                                {"--log", options.log}};
  for (const auto& one : outputs)
    for (const auto& other : outputs)
      if (&one < &other && app::is_same_output(one.second, other.second))
        throw UsageError(std::string(one.first) + " and " + other.first + " both name " + other.second +
                         "; each needs a file of its own");
}

/// Before anything is run, so that a file that cannot be written costs no time. An empty path is none.
std::ofstream open_output(const std::string& path, const std::vector<std::string>& scenarios) {
  require_none_of(scenarios, path);
  std::ofstream out;
  const std::string problem = path.empty() ? "" : app::open_for_writing(out, path);
  if (!problem.empty()) throw UsageError(problem);
  return out;
}

/// Of --capture, --perfetto or --html, which exclude each other.
std::ofstream open_capture(const ScenarioOptions& options) {
  const auto [option, path] =
      !options.capture.empty()    ? std::pair<std::string, std::string>("--capture", options.capture)
      : !options.perfetto.empty() ? std::pair<std::string, std::string>("--perfetto", options.perfetto)
                                  : std::pair<std::string, std::string>("--html", options.html);
  if (path.empty()) return {};
  if (options.live)
    throw UsageError(option + " works only under the virtual clock; with --live use 'ringctl traffic show -w FILE'");
  if (options.files.size() != 1) throw UsageError(option + ": one scenario at a time, its times begin at 0");
  return open_output(path, options.files);
}

void require_live(const Scenario& scenario, const std::string& transport) {
  std::string text;
  for (const std::string& reason : only_virtual(scenario, transport)) text += "\n  " + reason;
  if (!text.empty()) throw UsageError(scenario.path + ": only under the virtual clock (--sim):" + text);
}

void require_expectation(const Scenario& scenario) {
  if (!lasts(scenario))
    throw UsageError(scenario.path + ": it has no step, so no time passes and nothing would be tested; add one, as " +
                     "steps: [{at: 1s}] (docs/reference/scenarios.md)");
  if (expects_something(scenario)) return;
  throw UsageError(scenario.path +
                   ": nothing is expected, so nothing would be tested; add what has to be seen: a step " +
                   "with when and within, or always, or never (docs/reference/scenarios.md)");
}

/// @throw UsageError, ConfigError
Scenario load(const std::string& file, const ScenarioOptions& options) {
  Scenario scenario = scenario::load_scenario(file);
  require_expectation(scenario);
  if (options.live) require_live(scenario, options.transport);
  if (options.with_programs) require_virtual(scenario, {options.scenario_cpus, options.log});
  return scenario;
}

/// "40 scenarios: all as expected", or which were not.
std::string verdict_of(const std::vector<ScenarioRun>& runs) {
  std::string unmet;
  std::size_t count = 0;
  for (const ScenarioRun& run : runs) {
    if (!run.unmet) continue;
    ++count;
    unmet += "\n  " + run.path;
  }
  const std::string all = std::to_string(runs.size()) + " scenarios: ";
  return all + (count == 0 ? "all as expected" : std::to_string(count) + " not as expected:" + unmet);
}

ScenarioRun play(const Scenario& scenario, const ScenarioOptions& options, std::ostream* capture,
                 std::string& log_problem, process::SignalWait& signals) {
  const std::uint64_t seed = options.seed.value_or(scenario.seed);
  const sim::CaptureAt at = options.outputs ? sim::CaptureAt::inputs_and_outputs : sim::CaptureAt::inputs;
  if (options.live) return play_live(scenario, seed, options.transport, signals);
  if (options.with_programs)
    return play_virtual(scenario, seed, {options.scenario_cpus, options.log, capture, at, &log_problem}, signals);
  return run_scenario(scenario, seed, capture, at, [&signals] { throw_if_interrupted(signals); });
}

/// The run of the first order that fails, or of the last that is tried.
ScenarioRun play_orders(Scenario scenario, const ScenarioOptions& options, std::ostream* capture,
                        std::string& log_problem, process::SignalWait& signals) {
  std::uint32_t& order = scenario.ring.virtual_clock.order;
  const std::uint32_t first = order = options.order.value_or(options.orders > 1 ? 1 : order);
  Progress progress;
  for (;;) {
    ScenarioRun run = play(scenario, options, capture, log_problem, signals);
    if (run.unmet || order - first + 1 >= options.orders) return run;
    progress.tell(scenario.path + ": as expected in order " + std::to_string(order));
    throw_if_interrupted(signals);
    ++order;
  }
}

/// "orders 1 to 50: all as expected", or which is the first that is not.
std::string orders_text(const ScenarioRun& run, const ScenarioOptions& options) {
  if (options.orders == 1) return "";
  const std::string first = std::to_string(options.order.value_or(1)), last = std::to_string(run.order);
  return run.unmet ? "order " + last + " is the first of those from " + first +
                         " on that is not as expected; again with --order " + last + "\n"
                   : "orders " + first + " to " + last + ": all as expected\n";
}

/// What is whole only when all have been run: JSON and JUnit. @throw NotDone if it cannot be written
void report(const std::vector<ScenarioRun>& runs, const ScenarioOptions& options, std::ofstream& junit,
            const std::vector<Scenario>& scenarios, const std::string& stopped = {}) {
  std::vector<app::Row> rows;
  for (const ScenarioRun& each : runs) rows.push_back(row_of(each));
  if (options.json) std::cout << app::format_rows(rows, app::Format::json) << std::endl;
  if (junit.is_open()) finish(junit << scenario::junit_of(runs, scenarios, stopped), options.junit);
}

/// The same where something else has gone wrong, which is what counts.
void report_so_far(const std::vector<ScenarioRun>& runs, const ScenarioOptions& options, std::ofstream& junit,
                   const std::vector<Scenario>& scenarios, const std::string& stopped) try {
  report(runs, options, junit, scenarios, stopped);
} catch (const NotDone& problem) {
  tell_user(problem.what());
}

/// A build server, which looks at the report alone, learns of a file that is refused.
void report_refused(const std::string& file, const std::string& why, const ScenarioOptions& options,
                    std::ofstream& junit) try {
  Scenario refused;
  refused.path = refused.name = file;
  if (junit.is_open()) finish(junit << scenario::junit_of({}, {refused}, why), options.junit);
} catch (const NotDone& problem) {
  tell_user(problem.what());
}

// All files are read before the first is run: a bad one is known at once.
std::vector<Scenario> load_all(const ScenarioOptions& options, std::ofstream& junit) {
  std::vector<Scenario> scenarios;
  for (const std::string& file : options.files) {
    try {
      scenarios.push_back(load(file, options));
    } catch (const std::exception& problem) {
      report_refused(file, problem.what(), options, junit);
      throw;
    }
  }
  return scenarios;
}

int run(const ScenarioOptions& options) {
  if (const std::string problem = app::why_no_file(options.log); !problem.empty()) throw UsageError("--log " + problem);
  require_none_of(options.files, options.log);
  require_files_of_their_own(options);
  std::ofstream junit = open_output(options.junit, options.files);
  const std::vector<Scenario> scenarios = load_all(options, junit);
  std::ofstream capture = open_capture(options);
  std::stringstream captured;  // for a timeline or a page
  std::ostream* capture_to = capture.is_open() ? &capture : nullptr;
  if (options.capture.empty() && capture.is_open()) capture_to = &captured;
  std::vector<ScenarioRun> runs;
  std::string log_problem;
  process::SignalWait signals;
  try {
    for (const Scenario& scenario : scenarios) {
      throw_if_interrupted(signals);
      runs.push_back(play_orders(scenario, options, capture_to, log_problem, signals));
      if (!options.json) std::cout << text_of(runs.back()) << orders_text(runs.back(), options) << std::endl;
    }
    if (!options.perfetto.empty()) app::write_timeline(capture, captured, "the run");
    if (!options.html.empty()) app::write_states(capture, runs[0].name, captured, text_of(runs[0]), runs[0].lasted);
    if (capture.is_open()) finish(capture, options.capture + options.perfetto + options.html);
  } catch (const std::exception& problem) {  // interrupted, for one: what was found so far is not lost
    report_so_far(runs, options, junit, scenarios, problem.what());
    throw;
  }
  if (!options.json && runs.size() > 1) std::cout << verdict_of(runs) << std::endl;
  report(runs, options, junit, scenarios);
  if (!log_problem.empty()) throw NotDone(log_problem);
  const bool unmet =
      std::any_of(runs.begin(), runs.end(), [](const ScenarioRun& each) { return each.unmet.has_value(); });
  return unmet ? kNotDone : kDone;
}

/// On what kind of ring it is run, and what goes with one of them alone.
void add_rings(CLI::App& command, ScenarioOptions& options) {
  auto* sim = command.add_flag("--sim", "Under a virtual clock, with models of CPUs: the default");
  auto* with_programs =
      command.add_flag("--virtual", options.with_programs,
                       "Under a virtual clock, with the programs of the ring's file as CPUs, in lockstep");
  auto* live = command.add_flag("--live", options.live, "On live daemons, in a separate ring for each scenario");
  sim->excludes(live)->excludes(with_programs);
  live->excludes(with_programs);
  command.add_option("--log", options.log, "With --virtual: append what programs print and nodes log to this file")
      ->needs(with_programs);
  command
      .add_flag("--scenario-cpus", options.scenario_cpus,
                "With --virtual: the CPU of every node is scenario_cpu, which takes packets and sends none")
      ->needs(with_programs);
  command.add_option("--transport", options.transport, "With --live: unix, shm or udp for all lines")
      ->transform(cli::one_of(config::transport_words()))
      ->needs(live);
}

constexpr std::uint32_t kLastOrder = 1'000'000;

/// @throw CLI::ValidationError
void check_orders(const ScenarioOptions& options) {
  const std::uint32_t left = kLastOrder - options.order.value_or(1) + 1;
  if (options.orders > left)
    throw CLI::ValidationError("--orders", std::to_string(options.orders) + ": there are only " + std::to_string(left) +
                                               " from --order " + std::to_string(*options.order) + " on, up to " +
                                               std::to_string(kLastOrder));
}

void add_orders(CLI::App& command, ScenarioOptions& options) {
  CLI::Option* with_programs = command.get_option("--virtual");
  command
      .add_option("--order", options.order,
                  "With --virtual: seed of the order in which programs act in one instant, one after the other, 1 to "
                  "1000000; 0: side by side")
      ->transform(cli::whole(0, kLastOrder))
      ->needs(with_programs);
  command
      .add_option("--orders", options.orders,
                  "With --virtual: try so many of these seeds, 1 to 10000, from --order (default 1) on, and stop at "
                  "the first with which an expectation is not met")
      ->transform(cli::whole(1, 10'000))
      ->needs(with_programs)
      ->excludes(command.get_option("--capture"))
      ->excludes(command.get_option("--perfetto"))
      ->excludes(command.get_option("--html"));
}

void add_outputs(CLI::App& command, ScenarioOptions& options) {
  command.add_option("--junit", options.junit, "Write JUnit XML there");
  CLI::Option* capture =
      command.add_option("--capture", options.capture, "Write the packets on all lines there, as pcapng for Wireshark");
  CLI::Option* perfetto =
      command.add_option("--perfetto", options.perfetto, "Write the packets there as a timeline for ui.perfetto.dev")
          ->excludes(capture);
  command.add_option("--html", options.html, "Write a page there: the states of each node over time, and the report")
      ->excludes(capture)
      ->excludes(perfetto);
  command
      .add_flag("--outputs", options.outputs,
                "With --capture: also as they leave each node, which 'ringctl traffic why' needs")
      ->needs(capture);
}

void add_run(CLI::App& scenario, Context& context) {
  auto options = std::make_shared<ScenarioOptions>();
  CLI::App* command = add_command(scenario, "run", "Run scenarios", "ringctl scenario run walk.yaml --virtual",
                                  "Exits with 1 if an expectation was not met.");
  command->add_option("FILE", options->files, "Scenarios, YAML")->required();
  add_rings(*command, *options);
  add_outputs(*command, *options);
  add_orders(*command, *options);
  command->add_option("--seed", options->seed, "Seed, instead of the one in each file")
      ->transform(cli::whole(0, std::numeric_limits<std::int64_t>::max()));
  add_json(*command, options->json);
  command->callback([&context, options] {
    if (!context.ring.empty()) throw CLI::ValidationError("--ring", "a scenario has a ring of its own");
    check_orders(*options);
    context.action = [options] { return run(*options); };
  });
}

}  // namespace

void add_scenario(CLI::App& app, Context& context) {
  CLI::App* scenario = &add_group(app, "scenario", "Run faults by script, and check if the ring copes",
                                  "ringctl scenario run walk.yaml");
  add_scenario_list(*scenario, context);
  add_scenario_shrink(*scenario, context);
  add_scenario_cause(*scenario, context);
  add_run(*scenario, context);
}

}  // namespace limb_ring::ringctl
