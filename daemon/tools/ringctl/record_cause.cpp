#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>

#include "config/quantity.h"
#include "io/signal_wait.h"
#include "sim/recorded_story.h"
#include "tools/common/command_line.h"
#include "tools/common/picture_page.h"
#include "tools/common/ring_file.h"
#include "tools/ringctl/cause_page.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/play.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
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

/// @throw UsageError
std::ofstream open_page(const std::string& path) {
  std::ofstream page;
  const std::string problem = path.empty() ? "" : app::open_for_writing(page, path);
  if (!problem.empty()) throw UsageError("--html " + problem);
  return page;
}

/// The states of the nodes while the story lasts, its events that count, and the cause.
void write_page(std::ofstream& page, const RecordCauseOptions& options, const sim::RecordedStory& found,
                const scenario::Cause& cause, const std::string& text) {
  std::stringstream states;
  sim::capture_states(options.folder, found.from, found.broken_after, states);
  app::write_states(page, options.folder, states, text, found.broken_after - found.from,
                    marks_of(cause, *found.story, found.from));
  const std::string problem = cli::finish_writing(page, options.html);
  if (!problem.empty()) throw NotDone(problem);
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
  const auto cause = scenario::cause_of(*found.story, [&](std::size_t runs) {
    throw_if_interrupted(signals);
    progress.tell("the cause: " + std::to_string(runs) + " runs");
  });
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
  command->add_option("--html", options->html,
                      "Write a page there: the states of each node over time, the events that count, and the cause");
  command->callback([&context, options] { context.action = [options] { return find_cause(*options); }; });
}

}  // namespace limb_ring::ringctl
