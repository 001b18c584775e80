#include "tools/ring_sim/plan_rows.h"

#include <cmath>

#include "config/quantity.h"
#include "study/analysis/expected_losses.h"
#include "tools/common/text_table.h"

namespace limb_ring::ring_sim {

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
