#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>

#include "sim/scenario_report.h"
#include "sim/scenario_shrink.h"
#include "tools/cli/output.h"
#include "tools/cli/values.h"
#include "tools/common/out_file.h"
#include "tools/ringctl/command/commands.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/progress.h"

namespace limb_ring::ringctl {

namespace {

struct ShrinkOptions {
  scenario::ShrinkRequest request;
  std::string out;
};

void write(const std::string& text, const std::string& path) {
  if (path.empty()) {
    std::cout << text;
    return;
  }
  std::ofstream out;
  std::string problem = app::open_for_writing(out, path);
  out << text;
  if (problem.empty()) problem = cli::finish_writing(out, path);
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
  if (!shrunk)
    throw NotDone(options.request.path + " is as expected under the virtual clock: there is nothing to find");
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
  command->add_option("--seed", options->request.seed, "Instead of the file's own")
      ->transform(cli::whole(0, std::numeric_limits<std::int64_t>::max()));
  command->callback([&context, options] {
    if (!context.ring.empty()) throw CLI::ValidationError("--ring", "a scenario has a ring of its own");
    context.action = [options] { return run(*options); };
  });
}

}  // namespace limb_ring::ringctl
