#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>

#include "config/load_ring.h"
#include "config/quantity.h"
#include "study/plan.h"
#include "study/traffic_run.h"
#include "tools/common/command_line.h"
#include "tools/common/picture_page.h"
#include "tools/common/ring_file.h"
#include "tools/common/text_table.h"
#include "tools/ring_sim/command_line.h"

namespace limb_ring::ring_sim {

/// What `ring_sim plan` has found out.
struct PlanReport {
  config::RingConfig ring;  ///< every line has a rate
  bool assumed = false;     ///< ... and not all of them from the file
  std::vector<study::Stream> streams;
  study::Plan plan;
  std::vector<study::StreamRun> runs;  ///< empty: not simulated
  std::uint64_t seed = 0;
  study::Duration duration{0};

  bool kept() const;
};

/// A row for each stream, for programs. Times in us.
std::vector<app::Row> stream_rows(const PlanReport& report);
std::vector<app::Row> node_rows(const PlanReport& report);
/// The same for people: what fits into 80 columns, with one row for all beacons.
std::vector<app::Row> short_stream_rows(const PlanReport& report);
std::vector<app::Row> short_node_rows(const PlanReport& report);
/// Everything, for programs.
app::Row plan_object(const PlanReport& report);

namespace {

constexpr const char* kSimulated = "1s";
constexpr std::chrono::seconds kLongest{3600};

struct PlanOptions {
  std::string config;
  study::Medium medium;
  bool simulate = false;
  std::string duration = kSimulated;
  std::uint64_t seed = 1;
  std::string html;
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

std::vector<app::StreamLatencies> pictures_of(const PlanReport& report) {
  std::vector<app::StreamLatencies> streams;
  for (std::size_t s = 0; s < report.streams.size(); ++s) {
    // When a beacon is asked for is not to be seen: it counts from its first byte, until it is home.
    const bool beacon = report.streams[s].beacon;
    const study::Latencies& of = beacon ? report.runs[s].confirmed : report.runs[s].delivered;
    const auto& bound = beacon ? report.plan.streams[s].confirmed : report.plan.streams[s].delivered;
    streams.push_back({report.streams[s].name + (beacon ? ", until it is home" : ""), {}, {}});
    for (const core::Duration one : of.values()) streams.back().latencies.push_back(study::microseconds(one));
    if (bound) streams.back().bound = study::microseconds(*bound);
  }
  return streams;
}

void write_pictures(std::ofstream& file, const PlanReport& report, const PlanOptions& options) {
  write_latencies(file, report.ring.ring + ": latencies against their bounds",
                  "Simulated " + options.duration + " with seed " + std::to_string(report.seed) +
                      ", from the request of the CPU until all of a message is delivered. The dashed line is the worst "
                      "that 'ring_sim plan' computes.",
                  pictures_of(report));
  const std::string problem = cli::finish_writing(file, options.html);
  if (!problem.empty()) throw std::runtime_error(problem);
}

int run(const PlanOptions& options) {
  std::ofstream html;
  if (!options.html.empty())
    if (const std::string problem = app::open_for_writing(html, options.html); !problem.empty())
      throw UsageError("--html " + problem);
  const PlanReport report = make_report(options);
  if (html.is_open()) write_pictures(html, report, options);
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
          "Also run the ring under a virtual clock for this time, default 1s, and print what was measured beside the "
          "bounds")
      ->type_name("[TIME]")
      ->expected(0, 1)
      ->default_str(kSimulated)
      ->check(CLI::Validator(check_duration, ""));
  command->add_option("--html", options->html,
                      "With --simulate: write an HTML page with a histogram and the bound of each stream");
  add_seed(*command, options->seed);
  add_format(*command, options->format);
  command->callback([&context, command, options] {
    context.action = [command, options] {
      if (!options->html.empty() && !options->simulate)
        throw UsageError("--html goes with --simulate: a plan without it measures nothing");
      if (command->count("--seed") != 0 && !options->simulate)
        throw UsageError("--seed goes with --simulate: a plan without it draws nothing at random");
      return run(*options);
    };
  });
}

namespace {

using app::Row;
using study::Duration;
using study::Latencies;
using study::Stream;
using study::StreamPlan;
using study::StreamRun;

Row us(const std::optional<Duration>& duration) {
  return duration ? Row(study::microseconds(*duration)) : Row(nullptr);
}

Row us(const Latencies& latencies, Duration value) {
  return latencies.count() == 0 ? Row(nullptr) : Row(study::microseconds(value));
}

/// For people: to the nanosecond, rounded up.
Row largest(const Latencies& latencies) {
  return us(latencies, std::chrono::ceil<std::chrono::nanoseconds>(latencies.max()));
}

double percent(double share) { return std::round(share * 100000) / 1000; }

std::string name_of(const config::RingConfig& ring, study::NodeId place) {
  return place == wire::kBroadcast ? "all" : ring.nodes[place].name;
}

std::string urgency(const Stream& stream) {
  if (stream.interrupt) return "INT" + std::to_string(*stream.interrupt);
  return stream.beacon ? "NC" : std::to_string(stream.priority);
}

void add_latencies(Row& row, const std::string& name, const Latencies& latencies) {
  row[name + "_min_us"] = us(latencies, latencies.min());
  row[name + "_mean_us"] = us(latencies, latencies.mean());
  row[name + "_p99_us"] = us(latencies, latencies.quantile(0.99));
  row[name + "_max_us"] = us(latencies, latencies.max());
}

const char* verdict_of(const StreamPlan& plan) {
  if (!plan.delivered) return "no bound";
  return plan.late ? "late" : "in time";
}

void add_run(Row& row, const StreamPlan& plan, const StreamRun& run) {
  row["asked"] = run.asked;
  add_latencies(row, "delivered", run.delivered);
  add_latencies(row, "confirmed", run.confirmed);
  row["failed"] = run.failed();
  row["kept"] = study::kept(plan, run);
}

Row stream_row(const PlanReport& report, std::size_t s) {
  const Stream& stream = report.streams[s];
  const StreamPlan& plan = report.plan.streams[s];
  Row row{{"stream", stream.name},
          {"from", name_of(report.ring, stream.source)},
          {"to", name_of(report.ring, stream.destination)},
          {"priority", urgency(stream)},
          {"bytes", stream.bytes},
          {"packets", stream.packets.size()},
          {"rate_hz", stream.rate()},
          {"period_us", study::microseconds(stream.period)},
          {"deadline_us", study::microseconds(stream.late_after())},
          {"load_percent", percent(plan.load)},
          {"delivered_bound_us", us(plan.delivered)},
          {"confirmed_bound_us", us(plan.confirmed)},
          {"verdict", verdict_of(plan)}};
  if (!report.runs.empty()) add_run(row, plan, report.runs[s]);
  row["bound"] = plan.why;
  return row;
}

/// For 80 columns: names are cut, and times are whole us, rounded up where a bound is.
constexpr std::size_t kNameWidth = 22;

Row whole_us(const std::optional<Duration>& time) {
  return time ? Row(std::ceil(study::microseconds(*time))) : Row(nullptr);
}

Row short_row(const PlanReport& report, std::size_t s, const std::string& name) {
  const Stream& stream = report.streams[s];
  Row row{{"stream", app::shortened(name, kNameWidth)}, {"prio", urgency(stream)}, {"bytes", stream.bytes}};
  if (report.runs.empty()) row["period_us"] = whole_us(stream.period);
  row["deadline_us"] = whole_us(stream.late_after());
  row["bound_us"] = whole_us(report.plan.streams[s].delivered);
  if (!report.runs.empty()) row["measured"] = largest(report.runs[s].delivered);
  row["verdict"] = verdict_of(report.plan.streams[s]);
  return row;
}

}  // namespace

bool PlanReport::kept() const {
  for (std::size_t s = 0; s < runs.size(); ++s)
    if (!study::kept(plan.streams[s], runs[s])) return false;
  return true;
}

std::vector<Row> stream_rows(const PlanReport& report) {
  std::vector<Row> rows;
  for (std::size_t s = 0; s < report.streams.size(); ++s) rows.push_back(stream_row(report, s));
  return rows;
}

std::vector<Row> short_stream_rows(const PlanReport& report) {
  std::vector<Row> rows;
  std::optional<std::size_t> beacon;  // that with the largest bound stands for all
  std::size_t beacons = 0;
  for (std::size_t s = 0; s < report.streams.size(); ++s) {
    if (!report.streams[s].beacon) {
      rows.push_back(short_row(report, s, report.streams[s].name));
      continue;
    }
    ++beacons;
    const auto& bound = report.plan.streams[s].delivered;
    if (!beacon || !bound ||
        (report.plan.streams[*beacon].delivered && *bound > *report.plan.streams[*beacon].delivered))
      beacon = s;
  }
  if (beacon) rows.push_back(short_row(report, *beacon, "beacons of " + std::to_string(beacons) + " nodes"));
  return rows;
}

std::vector<Row> short_node_rows(const PlanReport& report) {
  std::vector<Row> rows;
  for (const Row& row : node_rows(report))
    rows.push_back({{"node", app::shortened(row["node"], 18)},
                    {"data_%", row["data_percent"]},
                    {"intr_%", row["interrupts_percent"]},
                    {"waiting_B", row["waiting_bytes"]},
                    {"line_%", row["line_in_percent"]},
                    {"line_rate", config::format_rate(row["line_in_bit_s"])},
                    {"delay_us", row["line_in_delay_us"]},
                    {"loss", row["line_in_loss"]}});
  return rows;
}

std::vector<Row> node_rows(const PlanReport& report) {
  std::vector<Row> rows;
  for (std::size_t n = 0; n < report.ring.nodes.size(); ++n) {
    const config::NodeConfig& node = report.ring.nodes[n];
    const std::size_t before = (n + report.ring.nodes.size() - 1) % report.ring.nodes.size();
    rows.push_back({{"node", node.name},
                    {"data_percent", percent(report.plan.nodes[n].data)},
                    {"interrupts_percent", percent(report.plan.nodes[n].interrupts)},
                    {"waiting_bytes", report.plan.nodes[n].waiting},
                    {"line_in_percent", percent(report.plan.lines[before])},
                    {"line_in_bit_s", node.link.rate},
                    {"line_in_delay_us", study::microseconds(node.link.whole_delay())},
                    {"line_in_loss", node.link.expected.loss}});
  }
  return rows;
}

Row plan_object(const PlanReport& report) {
  Row object{{"ring", report.ring.ring},
             {"carried", report.plan.carried()},
             {"limits", report.plan.limits},
             {"lines_assumed", report.assumed}};
  if (!report.runs.empty()) {
    object["seed"] = report.seed;
    object["simulated_us"] = study::microseconds(report.duration);
    object["kept"] = report.kept();
  }
  if (const auto losses = study::expected_losses(report.ring))
    object["expected_losses"] = {{"home_at_first_try", losses->home},
                                 {"home", losses->delivered},
                                 {"tries", losses->tries},
                                 {"try_timeout_us", study::microseconds(losses->timeout)}};
  object["nodes"] = node_rows(report);
  object["streams"] = stream_rows(report);
  return object;
}

}  // namespace limb_ring::ring_sim
