#include "tools/ring_sim/plan_rows.h"

#include <cmath>

#include "study/analysis/expected_losses.h"

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

void add_run(Row& row, const StreamPlan& plan, const StreamRun& run, bool all) {
  row["asked"] = run.asked;
  if (all) {
    add_latencies(row, "delivered", run.delivered);
    add_latencies(row, "confirmed", run.confirmed);
  } else {
    row["delivered_max"] = largest(run.delivered);
    row["confirmed_max"] = largest(run.confirmed);
  }
  row["failed"] = run.failed();
  row["kept"] = study::kept(plan, run);
}

Row stream_row(const PlanReport& report, std::size_t s, bool all) {
  const Stream& stream = report.streams[s];
  const StreamPlan& plan = report.plan.streams[s];
  Row row{{"stream", stream.name},
          {"from", name_of(report.ring, stream.source)},
          {"to", name_of(report.ring, stream.destination)},
          {"priority", urgency(stream)},
          {"bytes", stream.bytes},
          {"packets", stream.packets.size()},
          {"rate_hz", stream.rate()},
          {"load_percent", percent(plan.load)},
          {all ? "delivered_bound_us" : "delivered", us(plan.delivered)},
          {all ? "confirmed_bound_us" : "confirmed", us(plan.confirmed)}};
  if (!report.runs.empty()) add_run(row, plan, report.runs[s], all);
  row["bound"] = plan.why;
  return row;
}

}  // namespace

bool PlanReport::kept() const {
  for (std::size_t s = 0; s < runs.size(); ++s)
    if (!study::kept(plan.streams[s], runs[s])) return false;
  return true;
}

std::vector<Row> stream_rows(const PlanReport& report, bool all) {
  std::vector<Row> rows;
  for (std::size_t s = 0; s < report.streams.size(); ++s) rows.push_back(stream_row(report, s, all));
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
  object["streams"] = stream_rows(report, true);
  return object;
}

}  // namespace limb_ring::ring_sim
