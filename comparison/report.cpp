#include "comparison/report.h"

#include <functional>

#include "study/model_ring.h"
#include "tools/common/text_table.h"
#include "tools/ring_sim/command_line.h"
#include "wire/packet.h"

namespace limb_ring::comparison {

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

using app::number;

namespace {

using Cells = std::vector<std::string>;
using TextTable = std::vector<Cells>;

/// Enough digits for any two methods to differ, in as few columns.
std::string us(study::Duration duration) {
  const double value = study::microseconds(duration);
  return number(value, value < 1000 ? 2 : 1);
}
std::string percent_text(double share) { return number(100 * share, 1); }

void put(Cells& row, const Spread& spread) { row.insert(row.end(), {us(spread.worst), us(spread.mean)}); }

TextTable table_of(const Comparison& comparison, bool own_rate, const Cells& heading,
                   const std::function<void(Cells&, const Figures&)>& fill) {
  TextTable table{heading};
  for (const study::MethodRow& method : comparison.methods) {
    if (method.subject.own_rate != own_rate) continue;
    table.push_back({method.subject.method, ring_sim::megabits(method.subject.rate)});
    fill(table.back(), method.figures);
  }
  return table;
}

std::string latencies(const Comparison& comparison, bool own_rate) {
  const Cells heading{"", "Mbit/s", "alone", "mean", "opposite", "mean", "random", "mean", "load", "mean"};
  return app::text_table(table_of(comparison, own_rate, heading, [](Cells& row, const Figures& figures) {
    put(row, figures.alone);
    put(row, figures.at_once_opposite);
    put(row, figures.at_once_random);
    if (figures.random_load)
      put(row, *figures.random_load);
    else
      row.insert(row.end(), {"-", "-"});
  }));
}

std::string full_load(const Comparison& comparison, bool own_rate) {
  const Cells heading{"", "Mbit/s", "interrupt, us", "mean, us", "join, us", "efficiency, %"};
  return app::text_table(table_of(comparison, own_rate, heading, [](Cells& row, const Figures& figures) {
    put(row, figures.interrupt);
    row.insert(row.end(), {us(figures.join), percent_text(figures.efficiency)});
  }));
}

/// A row for each subject, a column for each of its points.
template <class Points>
std::string series(const Points& points, bool own_rate, Cells heading,
                   const std::function<std::string(const typename Points::value_type&)>& cell) {
  TextTable table{std::move(heading)};
  for (const auto& point : points) {
    if (point.subject.own_rate != own_rate) continue;
    if (table.size() == 1 || table.back().front() != point.subject.method)
      table.push_back({point.subject.method, ring_sim::megabits(point.subject.rate)});
    table.back().push_back(cell(point));
  }
  return app::text_table(table);
}

std::string against_load(const Comparison& comparison, const ComparisonOptions& options, bool own_rate) {
  Cells heading{"", "Mbit/s"};
  for (const double load : options.loads) heading.push_back(percent_text(load));
  return series(comparison.against_load, own_rate, heading,
                [](const study::LoadPoint& point) { return percent_text(point.delivered); });
}

std::string against_nodes(const Comparison& comparison, const ComparisonOptions& options, bool own_rate) {
  Cells heading{"", "Mbit/s"};
  for (const unsigned nodes : options.nodes) heading.push_back("N=" + std::to_string(nodes));
  return series(comparison.against_nodes, own_rate, heading,
                [](const study::NodesPoint& point) { return us(point.at_once.worst); });
}

std::string group(const Comparison& comparison, const ComparisonOptions& options, bool own_rate) {
  std::string text = own_rate ? "==== Each at its own rate (the paper's Table I) ====\n"
                              : "==== All at " + ring_sim::megabits(options.medium.rate) + " Mbit/s ====\n";
  text +=
      "\nLatency of a message, us, worst seen and mean: alone; all nodes at once, to the node opposite and\n"
      "to random ones; random load of " +
      percent_text(study::kRandomLoad) + " % of R ('-': saturated)\n";
  text += latencies(comparison, own_rate);
  text +=
      "\nUnder full load: latency of an interrupt-like message, worst seen and mean; time until a new node\n"
      "may send; payload delivered, % of R\n";
  text += full_load(comparison, own_rate);
  text += "\nPayload delivered, % of R, against payload offered, % of R\n";
  text += against_load(comparison, options, own_rate);
  text += "\nAll nodes at once, to the node opposite: worst latency, us, against the number of nodes\n";
  return text + against_nodes(comparison, options, own_rate) + "\n";
}

constexpr const char* kNotes =
    "What the models grant the others:\n"
    "- ARCNET, CAN: no propagation delay; no bus does 1 Gbit/s (at that rate it is arithmetic alone).\n"
    "- EtherCAT: frames without a pause, a master that needs no time, joining without link-up and EEPROM.\n"
    "- SERCOS II: the shortest cycle its telegrams permit, no bit stuffing.\n"
    "- Responsive Link: four lines out of every node at R each (ours has one), no line code; a node that\n"
    "  joins has lines of its own and nobody to wait for.\n"
    "Messages are asked for at any moment of the others' cycles; an application in step with its cycle\n"
    "waits up to a cycle less. While a node joins, ARCNET and SERCOS II stop all others. In saturation\n"
    "CAN starves the nodes with the highest identifiers. An ARCNET packet holds 508 bytes: 512 wait for\n"
    "the token twice.\n";

/// The worst case, which a run shows only if the others start at exactly the right instants. (docs/protocol.md)
std::string bound(const study::Medium& medium) {
  const study::Duration hop = medium.byte_time() * (medium.payload + wire::kOverhead) + medium.relay_delay;
  return "At " + ring_sim::megabits(medium.rate) +
         " Mbit/s limb_ring's bound after h hops is h (T + d), whatever data others\n" +
         "send: " + us((medium.nodes - 1) * hop) + " us to the farthest node, " + us(medium.nodes * hop) +
         " us until it is back.\n\n";
}

}  // namespace

std::string comparison_text(const Comparison& comparison, const ComparisonOptions& options) {
  const study::Medium& medium = options.medium;
  return std::to_string(medium.nodes) + " nodes, " + std::to_string(medium.payload) +
         " bytes of payload, relay delay " + number(study::microseconds(medium.relay_delay), 3) + " us, seed " +
         std::to_string(options.seed) + "\n\n" + group(comparison, options, false) + group(comparison, options, true) +
         bound(medium) + kNotes;
}

}  // namespace limb_ring::comparison
