#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>

#include "tools/cli/output.h"
#include "tools/cli/values.h"
#include "tools/common/out_file.h"
#include "tools/common/timeline.h"
#include "tools/ring_sim/case_rows.h"
#include "tools/ring_sim/commands.h"
#include "tools/ring_sim/problems.h"
#include "tools/ring_sim/progress.h"

namespace limb_ring::ring_sim {

namespace {

using study::Case;

struct RunOptions {
  Case which = Case::alone;
  study::Medium medium;
  std::uint64_t seed = 1;
  std::string trace, capture, perfetto;
  bool outputs = false;
  app::Format format = app::Format::text;
};

/// What is one row in JSON is a line each for people.
std::string in_lines(const app::Row& row) {
  std::vector<app::Row> lines;
  for (const auto& [name, value] : row.items())
    if (!value.is_null()) lines.push_back({{"figure", name}, {"value", value}});
  return app::format_rows(lines, app::Format::text);
}

/// @return where to write; none where it is not asked for
std::ostream* open(std::ofstream& file, const std::string& option, const std::string& path) {
  if (path.empty()) return nullptr;
  if (path == app::kStandardOutput) return &std::cout;
  const std::string problem = app::open_for_writing(file, path);
  if (!problem.empty()) throw UsageError(option + problem);
  return &file;
}

/// Of standard output the end of the program tells.
void finish(std::ofstream& file, const std::string& path) {
  const std::string problem = file.is_open() ? cli::finish_writing(file, path) : "";
  if (!problem.empty()) throw std::runtime_error(problem);
}

int run(const RunOptions& options) {
  if (options.perfetto == app::kStandardOutput)
    throw UsageError("--perfetto -: a timeline goes into a file, which ui.perfetto.dev opens; name one");
  if (app::is_same_output(options.trace, options.perfetto))
    throw UsageError("--trace and --perfetto both name " + options.perfetto + "; each needs a file of its own");
  if (app::is_same_output(options.trace, options.capture))
    throw UsageError("--trace and --capture both name " + options.capture + "; each needs a file of its own");
  std::ofstream trace, capture, perfetto;
  std::stringstream captured;
  study::CaseRecords records;
  records.trace = open(trace, "--trace ", options.trace);
  records.capture = open(capture, "--capture ", options.capture);
  if (open(perfetto, "--perfetto ", options.perfetto) != nullptr) records.capture = &captured;
  records.goes_on = [&options, progress = Progress()]() mutable {
    progress.tell(case_words(options.which, options.medium));
  };
  if (options.outputs) records.capture_at = sim::CaptureAt::inputs_and_outputs;
  const study::CaseResult result = run_case(options.which, options.medium, options.seed, records);
  finish(trace, options.trace);
  finish(capture, options.capture);
  if (perfetto.is_open()) app::write_timeline(perfetto, captured, "the run");
  finish(perfetto, options.perfetto);
  const app::Row row = run_row(options.which, options.medium, result, options.seed);
  std::ostream& out = records.trace == &std::cout || records.capture == &std::cout ? std::cerr : std::cout;
  if (options.format == app::Format::text) out << in_lines(row);
  if (options.format == app::Format::json) out << row.dump(2) << '\n';
  if (options.format == app::Format::csv) out << app::format_rows({row}, options.format);
  return kDone;
}

}  // namespace

void add_run(CLI::App& app, Context& context) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = add_command(app, "run", "Run one case, and print what was measured",
                                  "ring_sim run --case adversarial --nodes 16", kCasesHelp);
  std::map<std::string, Case> cases;
  for (const Case which : study::kCases) cases[to_string(which)] = which;
  command
      ->add_option("--case", options->which,
                   "alone, simultaneous, adversarial, request, delivery, interrupt, interrupt_bound, saturated, "
                   "random or payload (see below); default alone")
      ->transform(cli::word_of(cases));
  add_medium(*command, options->medium);
  add_seed(*command, options->seed);
  command->add_option(
      "--trace", options->trace,
      "Write everything that happened here: time in ps, node, what, and three figures of it; - is standard "
      "output, and what else it says goes to standard error");
  CLI::Option* capture = command->add_option(
      "--capture", options->capture, "Write the packets on all lines there, as pcapng for Wireshark; - as of --trace");
  command->add_flag("--outputs", options->outputs, "Also as they leave each node: 'ringctl traffic why' needs that")
      ->needs(capture);
  command->add_option("--perfetto", options->perfetto, "Write them there as a timeline, which ui.perfetto.dev loads")
      ->excludes(capture);
  add_format(*command, options->format);
  command->callback([&context, options] { context.action = [options] { return run(*options); }; });
}

}  // namespace limb_ring::ring_sim
