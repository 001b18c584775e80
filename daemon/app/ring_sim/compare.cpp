#include <chrono>
#include <iostream>
#include <memory>
#include <optional>

#include "app/common/text_table.h"
#include "app/ring_sim/commands.h"
#include "app/ring_sim/comparison_report.h"
#include "app/ring_sim/plots/plots.h"
#include "app/ring_sim/problems.h"

namespace limb_ring::ring_sim {

namespace {

struct Options {
  study::ComparisonOptions comparison;
  app::Format format = app::Format::text;
  std::optional<std::string> plots;  ///< folder
};

/// Says on standard error what is being measured, once it takes longer than two seconds.
void tell(const study::Subject& subject, std::chrono::steady_clock::time_point start) {
  if (std::chrono::steady_clock::now() - start < std::chrono::seconds(2)) return;
  std::cerr << "ring_sim: " << subject.method << " at " << app::number(static_cast<double>(subject.rate) * 1e-6, 0)
            << " Mbit/s ..." << std::endl;
}

int run(Options& options) {
  study::ComparisonOptions& comparison = options.comparison;
  if (!comparable(comparison.medium))
    throw UsageError("--relay-delay is more than 100 times as long as the payload takes on the line");
  std::optional<PlotFolder> plots;  // first: what is wrong with it is known before anything is measured
  if (options.plots) plots.emplace(*options.plots);
  const auto start = std::chrono::steady_clock::now();
  comparison.tell = [start](const study::Subject& subject) { tell(subject, start); };
  const study::Comparison result = compare(comparison);
  std::cout << format_comparison(result, comparison, options.format) << std::flush;
  if (plots) draw_all(*plots, {result, comparison});
  return kDone;
}

}  // namespace

void add_compare(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      app, "compare", "Measure the ring beside ARCNET, EtherCAT, SERCOS II, Responsive Link and CAN");
  add_medium(*command, options->comparison.medium);
  add_seed(*command, options->comparison.seed);
  add_format(*command, options->format);
  command->add_option("--plots", options->plots,
                      "Draw pictures into this folder too, as PNG and SVG, beside their data and gnuplot scripts")
      ->type_name("DIR");
  command->callback([&context, options] {
    context.action = [options] { return run(*options); };
  });
}

}  // namespace limb_ring::ring_sim
