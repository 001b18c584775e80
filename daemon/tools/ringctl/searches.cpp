// Searches in what fails: the smallest scenario, and the cause of a scenario or a recording.
#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <sstream>

#include "config/quantity.h"
#include "io/signal_wait.h"
#include "sim/load_scenario.h"
#include "sim/recorded_story.h"
#include "sim/scenario_cause.h"
#include "sim/scenario_report.h"
#include "sim/scenario_shrink.h"
#include "tools/common/command_line.h"
#include "tools/common/picture_page.h"
#include "tools/common/ring_file.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/play.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
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

// ---- causes ---------------------------------------------------------------------------------

namespace {

void add_page(CLI::App& command, std::string& path) {
  command.add_option("--html", path,
                     "Write a page there: the states of each node over time, the events that count, and the cause");
}

/// @throw UsageError
std::ofstream open_page(const std::string& path) {
  std::ofstream page;
  const std::string problem = path.empty() ? "" : app::open_for_writing(page, path);
  if (!problem.empty()) throw UsageError("--html " + problem);
  return page;
}

/// @throw NotDone
void close_page(std::ofstream& page, const std::string& path) {
  const std::string problem = cli::finish_writing(page, path);
  if (!problem.empty()) throw NotDone(problem);
}

/// The cause of a story, with progress. It is ended by Ctrl-C.
scenario::Cause cause_of(scenario::Story& story, const process::SignalWait& signals, Progress& progress) {
  return scenario::cause_of(story, [&](std::size_t runs) {
    throw_if_interrupted(signals);
    progress.tell("the cause: " + std::to_string(runs) + " runs");
  });
}

/// The events that a cause names, as marks on a picture of the nodes' states.
/// @param from the picture's time 0, in the story's time
std::vector<app::TimeMark> marks_of(const scenario::Cause& cause, const scenario::Story& story,
                                    std::chrono::nanoseconds from = std::chrono::nanoseconds(0)) {
  std::vector<app::TimeMark> marks;
  const auto add = [&](std::size_t event, const std::string& why) {
    marks.push_back({story.at(event) - from, std::to_string(event + 1), why + ": " + story.words(event)});
  };
  for (const auto& needed : cause.needed) add(needed.event, "needed");
  if (cause.sealed_by) add(*cause.sealed_by, "from here on every future fails");
  return marks;
}

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
  std::ofstream html = open_page(options.html);
  const std::uint64_t seed = options.seed.value_or(scenario.seed);
  std::string not_repeatable;
  const process::SignalWait signals;
  const scenario::Runner runner = runner_of(options, signals, not_repeatable);
  const auto story = scenario::story_of(scenario, seed, runner);
  if (!story) nothing_to_find(options.path);
  Progress progress;
  const scenario::Cause cause = cause_of(*story, signals, progress);
  std::string text = text_of(cause, *story);
  if (!not_repeatable.empty())
    text += "Another search may find another cause: not repeatable: " + not_repeatable + '\n';
  std::cout << text;
  if (options.html.empty()) return kDone;
  std::stringstream captured;
  const scenario::ScenarioRun whole = runner(scenario, seed, &captured);
  app::write_states(html, scenario.name, captured, text + '\n' + text_of(whole) + '\n', whole.lasted,
                    marks_of(cause, *story));
  close_page(html, options.html);
  return kDone;
}

}  // namespace

void add_scenario_cause(CLI::App& scenario, Context& context) {
  auto options = std::make_shared<CauseOptions>();
  CLI::App* command = add_command(scenario, "cause", "Say which event makes a scenario fail, and what would save it",
                                  "ringctl scenario cause walk.yaml --virtual",
                                  "Under the virtual clock. Ends with 1 if the scenario does not fail.");
  command->add_option("FILE", options->path, "The scenario, YAML")->required();
  command->add_flag("--virtual", options->with_programs,
                    "With the programs of the ring's file as CPUs; default: with models of CPUs");
  add_page(*command, options->html);
  add_search(*command, context, options->seed, [options] { return run(*options); });
}

namespace {

struct RecordCauseOptions {
  std::string folder, html;
};

/// @throw UsageError
sim::RecordedStory read_story(const std::string& folder, const process::SignalWait& signals, Progress& progress) {
  try {
    return sim::story_of(folder, {}, [&](const std::string& what) {
      throw_if_interrupted(signals);
      progress.tell(what);
    });
  } catch (const sim::UnreadableRecording& problem) {
    throw UsageError(problem.what());
  }
}

std::string text_of(const sim::RecordedStory& found) {
  const promises::Breach& breach = *found.breach;
  std::string text = "promise broken " + config::time_text(found.broken_after) + " after the first record, at node " +
                     std::to_string(breach.node) + ": " + to_string(breach.promise) + ": " + breach.what + '\n';
  if (found.story)
    text += "Events are what came from outside from " + config::time_text(found.from) +
            " after the first record on; all before is kept.\n";
  return text;
}

/// The states of the nodes while the story lasts, its events that count, and the cause.
void write_page(std::ofstream& page, const RecordCauseOptions& options, const sim::RecordedStory& found,
                const scenario::Cause& cause, const std::string& text) {
  std::stringstream states;
  sim::capture_states(options.folder, found.from, found.broken_after, states);
  app::write_states(page, options.folder, states, text, found.broken_after - found.from,
                    marks_of(cause, *found.story, found.from));
  close_page(page, options.html);
}

int no_cause(const std::string& why) {
  tell_user(why);
  return kNotDone;
}

int find_cause(const RecordCauseOptions& options) {
  std::ofstream page = open_page(options.html);
  const process::SignalWait signals;
  Progress progress;
  const sim::RecordedStory found = read_story(options.folder, signals, progress);
  if (!found.breach) return no_cause("the recording breaks no promise: there is no cause to find");
  std::cout << text_of(found) << std::flush;
  if (!found.story) return no_cause("its failure does not come again: " + found.why_not);
  const scenario::Cause cause = cause_of(*found.story, signals, progress);
  const std::string text = text_of(cause, *found.story);
  std::cout << text;
  if (page.is_open()) write_page(page, options, found, cause, text_of(found) + text);
  return kDone;
}

}  // namespace

void add_record_cause(CLI::App& record, Context& context) {
  auto options = std::make_shared<RecordCauseOptions>();
  CLI::App* command = add_command(
      record, "cause", "Say which event made a recorded ring break a promise, and what would save it",
      "ringctl record cause what-happened",
      "Goes on from the recorded cores with fewer events, and with other futures from each of them on. Ends with 1 if "
      "the recording breaks no promise, or if its failure does not come again.");
  command->add_option("DIR", options->folder, "Folder of 'ringctl record save'")->required();
  add_page(*command, options->html);
  command->callback([&context, options] { context.action = [options] { return find_cause(*options); }; });
}

}  // namespace limb_ring::ringctl
