#include <algorithm>

#include "comparison/plots/picture.h"
#include "study/model_ring.h"
#include "tools/ring_sim/command_line.h"

namespace limb_ring::comparison {

namespace {

constexpr const char* kPlot = R"(set xlabel 'Nodes N'
set ylabel 'Worst latency to the node opposite, us'
set logscale xy
set xrange [0.9*least:1.1*most]
set xtics 2
set mxtics 1
set grid
set key below Left reverse height 1 maxrows 3
plot for [k=2:columns-1] file using 1:k with linespoints linetype k-1 title columnheader(k), \
  file using 1:columns with lines linetype 7 title columnheader(columns)
)";

std::vector<Column> columns_of(const PlotInput& input, bool own_rate) {
  std::vector<Column> columns{{"nodes", {}}};
  for (const unsigned nodes : input.options.nodes) columns.front().cells.push_back(std::to_string(nodes));
  for (const study::NodesPoint& point : input.comparison.against_nodes) {
    const study::Subject& subject = point.subject;
    const std::string rate = own_rate ? " at " + ring_sim::megabits(subject.rate) + " Mbit/s" : "";
    if (subject.own_rate == own_rate) add_point(columns, subject.method + rate, us(point.at_once.worst));
  }
  return columns;
}

/// That of our ring, which is the first method of its group.
study::Medium medium_of_ours(const PlotInput& input, bool own_rate) {
  study::Medium medium = input.options.medium;
  const auto& methods = input.comparison.methods;
  const auto ours = std::find_if(methods.begin(), methods.end(),
                                 [own_rate](const study::MethodRow& row) { return row.subject.own_rate == own_rate; });
  medium.rate = ours->subject.rate;
  return medium;
}

Column bound(const PlotInput& input, bool own_rate) {
  study::Medium medium = medium_of_ours(input, own_rate);
  Column column{"bound of limb_ring: N/2 (T + d)", {}};
  for (const unsigned nodes : input.options.nodes) {
    medium.nodes = nodes;
    column.cells.push_back(us(data_bound(medium, nodes / 2)));
  }
  return column;
}

std::string range(const std::vector<unsigned>& nodes) {
  return "least = " + std::to_string(nodes.front()) + "\nmost = " + std::to_string(nodes.back()) + "\n";
}

std::string figures(const PlotInput& input, bool own_rate) {
  const auto& nodes = input.options.nodes;
  const std::string from_to = std::to_string(nodes.front()) + " to " + std::to_string(nodes.back());
  return figures_of(input.options, from_to, own_rate ? "the method's own" : rate_of(input.options.medium));
}

Picture latencies_of(const PlotInput& input, bool own_rate) {
  const std::string name = own_rate ? "latency_nodes_own_rates" : "latency_nodes";
  std::vector<Column> columns = columns_of(input, own_rate);
  columns.push_back(bound(input, own_rate));
  const std::string what = own_rate ? "All nodes start one message at once, each method at its own rate"
                                    : "All nodes start one message at once";
  return {name, csv_of(columns),
          title(what, figures(input, own_rate)) + range(input.options.nodes) + "file = '" + name +
              ".csv'\ncolumns = " + std::to_string(columns.size()) + "\n" + kPlot};
}

}  // namespace

Picture plot_latency_nodes(const PlotInput& input) { return latencies_of(input, /*own_rate=*/false); }

Picture plot_latency_nodes_own_rates(const PlotInput& input) { return latencies_of(input, /*own_rate=*/true); }

}  // namespace limb_ring::comparison
