#include "comparison/command_line.h"

#include <iostream>
#include <optional>

#include "comparison/plots.h"
#include "comparison/report.h"
#include "tools/common/command_line.h"
#include "tools/ring_sim/command_line.h"

namespace limb_ring::comparison {
namespace {

struct Options {
  study::ComparisonOptions comparison;
  app::Format format = app::Format::text;
  std::optional<std::string> plots;  ///< folder
};

void run(Options& options) {
  study::ComparisonOptions& comparison = options.comparison;
  if (!comparable(comparison.medium))
    throw ring_sim::UsageError(
        "a full load of messages does not fit into memory: fewer --nodes, more --payload or a shorter "
        "--relay-delay (at --rate, and at 1000 Mbit/s, the ring's own rate) is needed");
  std::optional<PlotFolder> plots;  // made first: a folder that cannot be written ends this before anything is measured
  if (options.plots) plots.emplace(*options.plots);
  comparison.tell = [progress = ring_sim::Progress("compare_networks")](const study::Subject& subject) mutable {
    progress.tell(subject.method + (" at " + app::number(static_cast<double>(subject.rate) * 1e-6, 0)) + " Mbit/s");
  };
  const study::Comparison result = compare(comparison);
  std::cout << format_comparison(result, comparison, options.format) << std::flush;
  if (plots) draw_all(*plots, {result, comparison});
}

void add_options(CLI::App& app, Options& options) {
  app.footer(cli::footer("", "compare_networks --nodes 16 --payload 64",
                         "Exit code: 0 done\n"
                         "  1 gnuplot is missing or fails, a disk is full, or it was interrupted\n"
                         "  2 wrong arguments, or a folder that cannot be written"));
  ring_sim::add_medium(app, options.comparison.medium);
  ring_sim::add_seed(app, options.comparison.seed);
  ring_sim::add_format(app, options.format);
  app.add_option("--plots", options.plots,
                 "Draw pictures into this folder too, as PNG and SVG, beside their data and gnuplot scripts")
      ->type_name("DIR");
}

int failed(const std::exception& problem, ring_sim::ExitCode code) {
  std::cerr << "compare_networks: " << problem.what() << '\n';
  return code;
}

}  // namespace

int run_command_line(int argc, char** argv) {
  Options options;
  CLI::App app("The ring beside ARCNET, EtherCAT, SERCOS II, Responsive Link and CAN.", "compare_networks");
  add_options(app, options);
  if (const auto end = cli::parse(app, argc, argv)) return *end;
  try {
    run(options);
    return ring_sim::kDone;
  } catch (const ring_sim::UsageError& problem) {
    return failed(problem, ring_sim::kUsage);
  } catch (const std::exception& problem) {
    return failed(problem, ring_sim::kBroken);
  }
}

}  // namespace limb_ring::comparison
