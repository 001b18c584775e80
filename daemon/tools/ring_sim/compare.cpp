#include <iostream>
#include <memory>
#include <optional>

#include "tools/common/text_table.h"
#include "tools/ring_sim/commands.h"
#include "tools/ring_sim/comparison_report.h"
#include "tools/ring_sim/plots/plots.h"
#include "tools/ring_sim/problems.h"
#include "tools/ring_sim/progress.h"

namespace limb_ring::ring_sim {

namespace {

struct CompareOptions {
  study::ComparisonOptions comparison;
  app::Format format = app::Format::text;
  std::optional<std::string> plots;  ///< folder
};

int run(CompareOptions& options) {
  study::ComparisonOptions& comparison = options.comparison;
  if (!comparable(comparison.medium))
    throw UsageError(
        "a full load of messages does not fit into memory: fewer --nodes, more --payload or a shorter "
        "--relay-delay (at --rate, and at 1000 Mbit/s, the ring's own rate) is needed");
  std::optional<PlotFolder> plots;  // made first: a folder that cannot be written ends this before anything is measured
  if (options.plots) plots.emplace(*options.plots);
  comparison.tell = [progress = Progress()](const study::Subject& subject) mutable {
    progress.tell(subject.method + (" at " + app::number(static_cast<double>(subject.rate) * 1e-6, 0)) + " Mbit/s");
  };
  const study::Comparison result = compare(comparison);
  std::cout << format_comparison(result, comparison, options.format) << std::flush;
  if (plots) draw_all(*plots, {result, comparison});
  return kDone;
}

}  // namespace

void add_compare(CLI::App& app, Context& context) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command = add_command(app, "compare", "Compare with ARCNET, EtherCAT, SERCOS II, CAN ...",
                                  "ring_sim compare --nodes 16 --payload 64");
  add_medium(*command, options->comparison.medium);
  add_seed(*command, options->comparison.seed);
  add_format(*command, options->format);
  command
      ->add_option("--plots", options->plots,
                   "Draw pictures into this folder too, as PNG and SVG, beside their data and gnuplot scripts")
      ->type_name("DIR");
  command->callback([&context, options] { context.action = [options] { return run(*options); }; });
}

}  // namespace limb_ring::ring_sim
