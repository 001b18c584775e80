#include "study/analysis/plan.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>

#include "config/load_ring.h"
#include "config/quantity.h"
#include "study/analysis/expected_losses.h"
#include "tools/common/ring_file.h"
#include "tools/common/text_table.h"
#include "tools/ring_sim/commands.h"
#include "tools/ring_sim/plan_rows.h"
#include "tools/ring_sim/problems.h"
#include "tools/ring_sim/progress.h"

namespace limb_ring::ring_sim {

namespace {

constexpr const char* kSimulated = "1s";
constexpr std::chrono::seconds kLongest{3600};

struct PlanOptions {
  std::string config;
  study::Medium medium;
  bool simulate = false;
  std::string duration = kSimulated;
  std::uint64_t seed = 1;
  app::Format format = app::Format::text;
};

std::string check_duration(const std::string& text) {
  const auto time = config::parse_time(text);
  if (time && time->count() > 0 && *time <= kLongest) return {};
  return "'" + text + "' is not a time above 0s up to 3600s, with its unit: 500ms, 10s";
}

PlanReport make_report(const PlanOptions& options) {
  PlanReport report;
  const config::RingConfig ring = config::load_ring(app::ring_file(options.config));
  for (const std::string& warning : ring.warnings) std::cerr << "ring_sim: warning: " << warning << std::endl;
  report.assumed = sim::assumes_lines(ring);
  const auto delay = core::whole_nanoseconds(options.medium.relay_delay);
  report.ring = sim::with_assumed_lines(ring, options.medium.rate, delay);
  report.streams = study::streams_of(report.ring);
  report.plan = study::plan(report.ring, report.streams);
  if (!options.simulate) return report;
  report.seed = options.seed;
  report.duration = *config::parse_time(options.duration);
  const auto tell = [progress = Progress()](double share) mutable {
    progress.tell("simulated " + app::number(100 * share, 0) + " %");
  };
  report.runs = study::run_traffic(report.ring, report.streams, {report.duration, options.seed, tell});
  return report;
}

std::string broken_words(const study::StreamRun& run) {
  if (run.failed() != 0) return std::to_string(run.failed()) + " packets were not delivered";
  if (run.confirmed.count() < run.asked) return std::to_string(run.asked - run.confirmed.count()) + " never came home";
  return "later than its bound";
}

std::string simulated_words(const PlanReport& report, const std::string& duration) {
  std::string text = "Simulated " + duration + " with seed " + std::to_string(report.seed) +
                     "; a beacon's time counts from its first byte on the line. ";
  if (report.kept()) return text + "Every message that has a bound came within it.\n";
  text += "Not as planned:\n";
  for (std::size_t s = 0; s < report.runs.size(); ++s)
    if (!study::kept(report.plan.streams[s], report.runs[s]))
      text += "  '" + report.streams[s].name + "': " + broken_words(report.runs[s]) + "\n";
  return text;
}

std::string assumed_words(const study::Medium& medium) {
  const auto delay = core::whole_nanoseconds(medium.relay_delay);
  return "Assumed for lines without a rate: " + config::format_rate(medium.rate) + ", relay delay " +
         config::format_time(delay) + ".\n";
}

std::string text_of(const PlanReport& report, const PlanOptions& options) {
  std::string text = app::format_rows(short_stream_rows(report), app::Format::text);
  text += "\n" + app::format_rows(short_node_rows(report), app::Format::text) + "\n";
  text +=
      "Bounds are the worst cases from the CPU's request for a message until all of it is delivered. --json says\n"
      "more of each stream: from, to, rate, load, when it is confirmed, and what its bound consists of.\n";
  if (report.assumed) text += assumed_words(options.medium);
  text += study::expected_words(report.ring);
  if (!report.runs.empty()) text += simulated_words(report, options.duration);
  return text + study::verdict(report.ring, report.plan);
}

int run(const PlanOptions& options) {
  const PlanReport report = make_report(options);
  if (options.format == app::Format::text) std::cout << text_of(report, options);
  if (options.format == app::Format::json) std::cout << plan_object(report).dump(2) << '\n';
  if (options.format == app::Format::csv) std::cout << app::format_rows(stream_rows(report), options.format);
  return report.plan.carried() && report.kept() ? kDone : kBroken;
}

}  // namespace

void add_plan(CLI::App& app, Context& context) {
  auto options = std::make_shared<PlanOptions>();
  CLI::App* command =
      add_command(app, "plan", "Compute the worst latencies of a ring's file", "ring_sim plan leg8 --simulate",
                  "Covers everything that the file makes nodes send, and says if the ring carries it. Lines without "
                  "a rate in the file get --rate and --relay-delay.");
  command->add_option("CONFIG", options->config, "The ring's YAML file, or its name, such as leg8")->required();
  add_lines(*command, options->medium);
  command
      ->add_option_function<std::string>(
          "--simulate",
          [options](const std::string& text) {
            options->simulate = true;
            options->duration = text;
          },
          "Run it under a virtual clock for so long, default 1s, and set what was measured beside the bounds")
      ->type_name("[TIME]")
      ->expected(0, 1)
      ->default_str(kSimulated)
      ->check(CLI::Validator(check_duration, ""));
  add_seed(*command, options->seed);
  add_format(*command, options->format);
  command->callback([&context, command, options] {
    context.action = [command, options] {
      if (command->count("--seed") != 0 && !options->simulate)
        throw UsageError("--seed goes with --simulate: a plan without it draws nothing at random");
      return run(*options);
    };
  });
}

}  // namespace limb_ring::ring_sim
