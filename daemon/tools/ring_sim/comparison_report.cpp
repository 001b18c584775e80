#include "tools/ring_sim/comparison_report.h"

#include "study/analysis/latency.h"
#include "tools/ring_sim/comparison_text.h"

namespace limb_ring::ring_sim {

using app::Row;
using study::Comparison;
using study::ComparisonOptions;
using study::Figures;
using study::microseconds;
using study::Spread;
using study::Subject;

namespace {

double in_mbit_s(std::uint64_t rate) { return static_cast<double>(rate) / 1e6; }

Row row_of(const Subject& subject) {
  return {{"method", subject.method}, {"own_rate", subject.own_rate}, {"rate_mbit_s", in_mbit_s(subject.rate)}};
}

void put(Row& row, const std::string& name, const Spread& spread) {
  row[name + "_worst_us"] = microseconds(spread.worst);
  row[name + "_mean_us"] = microseconds(spread.mean);
}

Row row_of(const study::MethodRow& method) {
  const Figures& figures = method.figures;
  Row row = row_of(method.subject);
  put(row, "alone", figures.alone);
  put(row, "at_once_opposite", figures.at_once_opposite);
  put(row, "at_once_random", figures.at_once_random);
  if (figures.random_load) {
    put(row, "random_load", *figures.random_load);
  } else {
    row["random_load_worst_us"] = nullptr;
    row["random_load_mean_us"] = nullptr;
  }
  put(row, "interrupt", figures.interrupt);
  row["join_us"] = microseconds(figures.join);
  row["efficiency"] = figures.efficiency;
  return row;
}

Row row_of(const study::LoadPoint& point) {
  Row row = row_of(point.subject);
  row["offered"] = point.offered;
  row["delivered"] = point.delivered;
  return row;
}

Row row_of(const study::NodesPoint& point) {
  Row row = row_of(point.subject);
  row["nodes"] = point.nodes;
  put(row, "at_once_opposite", point.at_once);
  return row;
}

template <class Points>
std::vector<Row> rows_of(const Points& points) {
  std::vector<Row> rows;
  for (const auto& point : points) rows.push_back(row_of(point));
  return rows;
}

Row medium_of(const ComparisonOptions& options) {
  return {{"nodes", options.medium.nodes},
          {"payload_bytes", options.medium.payload},
          {"rate_mbit_s", in_mbit_s(options.medium.rate)},
          {"relay_delay_us", microseconds(options.medium.relay_delay)},
          {"random_load", study::kRandomLoad},
          {"seed", options.seed}};
}

// ---- JSON and CSV -------------------------------------------------------------------------

std::string json(const Comparison& comparison, const ComparisonOptions& options) {
  Row all = medium_of(options);
  all["methods"] = rows_of(comparison.methods);
  all["efficiency_against_load"] = rows_of(comparison.against_load);
  all["latency_against_nodes"] = rows_of(comparison.against_nodes);
  return all.dump(2) + "\n";
}

/// One row for every value in `rows`, except the subject and `against`; the options come first in each row.
void put_values(const Row& front, const std::vector<Row>& rows, const std::string& against, std::vector<Row>& out) {
  for (const Row& row : rows) {
    for (const auto& [name, value] : row.items()) {
      if (name == "method" || name == "own_rate" || name == "rate_mbit_s" || name == against) continue;
      out.push_back({{"seed", front["seed"]},
                     {"method", row["method"]},
                     {"own_rate", row["own_rate"]},
                     {"rate_mbit_s", row["rate_mbit_s"]},
                     {"nodes", against == "nodes" ? row["nodes"] : front["nodes"]},
                     {"offered", against == "offered" ? row["offered"] : Row(nullptr)},
                     {"quantity", name},
                     {"value", value}});
    }
  }
}

std::string csv(const Comparison& comparison, const ComparisonOptions& options) {
  const Row front = medium_of(options);
  std::vector<Row> rows;
  put_values(front, rows_of(comparison.methods), "", rows);
  put_values(front, rows_of(comparison.against_load), "offered", rows);
  put_values(front, rows_of(comparison.against_nodes), "nodes", rows);
  return app::format_rows(rows, app::Format::csv);
}

}  // namespace

std::string format_comparison(const Comparison& comparison, const ComparisonOptions& options, app::Format format) {
  if (format == app::Format::json) return json(comparison, options);
  if (format == app::Format::csv) return csv(comparison, options);
  return comparison_text(comparison, options);
}

}  // namespace limb_ring::ring_sim
