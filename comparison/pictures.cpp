#include "comparison/pictures.h"

#include <algorithm>
#include <sstream>

#include "comparison/measurements.h"
#include "study/model_ring.h"
#include "tools/common/text_table.h"
#include "tools/ring_sim/command_line.h"

namespace limb_ring::comparison {
namespace {

constexpr int kPicoseconds = 6;  // decimals of a us

/// A column of a picture's figures.
struct Column {
  std::string name;  ///< without commas and quotes
  std::vector<std::string> cells;
};

/// A time in us, to the picosecond.
std::string exact_us(study::Duration duration) { return app::number(study::microseconds(duration), kPicoseconds); }

/// "1000 Mbit/s"
std::string rate_of(const study::Medium& medium) { return ring_sim::megabits(medium.rate) + " Mbit/s"; }

/// "N = 16, B = 512 bytes, R = 1000 Mbit/s, d = 0.512 us, seed 1".
std::string figures_of(const study::ComparisonOptions& options, const std::string& nodes, const std::string& rate) {
  std::ostringstream text;
  text << "N = " << nodes << ", B = " << options.medium.payload << " bytes, R = " << rate
       << ", d = " << study::microseconds(options.medium.relay_delay) << " us, seed " << options.seed;
  return text.str();
}

/// The same with the nodes and the rate of its medium.
std::string figures_of(const study::ComparisonOptions& options) {
  return figures_of(options, std::to_string(options.medium.nodes), rate_of(options.medium));
}

/// `set title` with these lines.
std::string title(const std::string& first, const std::string& second) {
  return "set title \"" + first + "\\n" + second + "\"\n";
}

/// As CSV with a heading. @pre all columns have the same number of cells
std::string csv_of(const std::vector<Column>& columns) {
  std::string text;
  for (const Column& column : columns) text += (&column == &columns.front() ? "" : ",") + column.name;
  text += '\n';
  for (std::size_t row = 0; row < columns.front().cells.size(); ++row) {
    for (const Column& column : columns) text += (&column == &columns.front() ? "" : ",") + column.cells[row];
    text += '\n';
  }
  return text;
}

/// Adds a point of a method's curve: to the last column where it is that method's, else to a new one.
void add_point(std::vector<Column>& columns, const std::string& method, const std::string& cell) {
  if (columns.empty() || columns.back().name != method) columns.push_back({method, {}});
  columns.back().cells.push_back(cell);
}

// ---- Latency against the number of nodes ----

constexpr const char* kLatencyPlot = R"(set xlabel 'Nodes N'
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
    if (subject.own_rate == own_rate) add_point(columns, subject.method + rate, exact_us(point.at_once.worst));
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
    column.cells.push_back(exact_us(data_bound(medium, nodes / 2)));
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
              ".csv'\ncolumns = " + std::to_string(columns.size()) + "\n" + kLatencyPlot};
}

}  // namespace

Picture plot_latency_nodes(const PlotInput& input) { return latencies_of(input, /*own_rate=*/false); }

Picture plot_latency_nodes_own_rates(const PlotInput& input) { return latencies_of(input, /*own_rate=*/true); }

// ---- Efficiency under random load ----

namespace {

// The ideal comes first, below what reaches it.
constexpr const char* kEfficiencyPlot = R"(set xlabel 'Payload offered, % of R'
set ylabel 'Payload delivered, % of R'
set xrange [0:104]
set yrange [0:104]
set grid
set key top left
plot x with lines linetype 7 title 'ideal: all that is offered', \
  for [k=2:columns] 'efficiency.csv' using 1:k with linespoints linetype k-1 title columnheader(k)
)";

std::string percent_of(double share) { return app::number(100 * share, 3); }

}  // namespace

Picture plot_efficiency(const PlotInput& input) {
  std::vector<Column> columns{{"offered_percent", {}}};
  for (const double load : input.options.loads) columns.front().cells.push_back(percent_of(load));
  for (const study::LoadPoint& point : input.comparison.against_load)
    if (!point.subject.own_rate) add_point(columns, point.subject.method, percent_of(point.delivered));
  return {"efficiency", csv_of(columns),
          title("Efficiency under random load", figures_of(input.options)) +
              "columns = " + std::to_string(columns.size()) + "\n" + kEfficiencyPlot};
}

// ---- Round trips under random load ----

namespace {

constexpr double kOfSaturation = 0.95;
constexpr int kBinsToBound = 75;

// The few that come near the bound matter most, so the axis is logarithmic.
constexpr const char* kRoundTripsPlot = R"(set xlabel 'Round trip, start of sending to tail back, us'
set ylabel 'Packets, %'
set xrange [0:1.1*bound]
set logscale y
set yrange [one/2:*]
set grid
set style fill solid 0.7 border linecolor rgb 'white'
set arrow from bound, graph 0 to bound, graph 1 nohead front linetype 7
set key below Left reverse height 1
plot 'round_trips.csv' using (($1+$2)/2):4:($2-$1) with boxes linetype 1 title 'limb_ring', \
  NaN with lines linetype 7 title sprintf("bound N (T + d) = %.3f us", bound)
)";

std::string share_of(std::size_t count, const study::Latencies& all) {
  return app::number(100.0 * static_cast<double>(count) / static_cast<double>(all.count()), 6);
}

Picture bins_picture(const study::Latencies& all, const std::vector<study::Bin>& bins) {
  std::vector<Column> columns{{"from_us", {}}, {"to_us", {}}, {"packets", {}}, {"percent", {}}};
  for (const study::Bin& bin : bins) {
    columns[0].cells.push_back(exact_us(bin.from));
    columns[1].cells.push_back(exact_us(bin.to));
    columns[2].cells.push_back(std::to_string(bin.count));
    columns[3].cells.push_back(share_of(bin.count, all));
  }
  return {"round_trips", csv_of(columns), {}};
}

}  // namespace

Picture plot_round_trips(const PlotInput& input) {
  const study::Medium& medium = input.options.medium;
  // The first method of a comparison is our ring, at the medium's rate.
  const double load = kOfSaturation * input.comparison.methods.front().figures.efficiency;
  const study::Latencies all = data_round_trips(medium, load, input.options.seed);
  const study::Duration bound = data_bound(medium, medium.nodes);
  const study::Duration width = (bound + study::Duration{kBinsToBound - 1}) / kBinsToBound;  // the bound ends a bin
  Picture out = bins_picture(all, study::histogram(all.values(), width));
  const std::string what = "Round trips of " + std::to_string(all.count()) + " packets under random load of " +
                           app::number(100 * load, 1) + " % of R, worst " +
                           app::number(study::microseconds(all.max()), 3) + " us";
  out.script = title(what, figures_of(input.options)) + "bound = " + exact_us(bound) + "\n" +
               "one = " + share_of(1, all) + "\n" + kRoundTripsPlot;
  return out;
}

// ---- Embedded interrupts ----

namespace {

constexpr int kSteps = 500;  // of the distribution

// Ten times apart: on a logarithmic axis both can be read.
constexpr const char* kEmbeddingPlot = R"(set xlabel 'Round trip of an interrupt, request to return, us'
set ylabel 'Interrupts that are back by then, %'
set logscale x
set xrange [0.8*least:1.25*bound_between]
set yrange [0:100]
set xtics (1)
do for [decade=-3:9] {
  do for [step in '1 1.5 2 3 4 5 7'] {
    set xtics add (sprintf('%g', step * 10.0**decade) step * 10.0**decade)
  }
}
set grid
set arrow from bound_embedded, graph 0 to bound_embedded, graph 1 nohead front linetype 7
set arrow from bound_between, graph 0 to bound_between, graph 1 nohead front linetype 8
set key below Left reverse height 1 maxrows 2
plot 'embedding.csv' using 2:1 with lines linetype 1 \
    title sprintf("embedded into DATPs, worst %.3f us", worst_embedded), \
  NaN with lines linetype 7 title sprintf("its bound: %.3f us", bound_embedded), \
  '' using 3:1 with lines linetype 2 title sprintf("between DATPs only, worst %.3f us", worst_between), \
  NaN with lines linetype 8 title sprintf("its bound: %.3f us", bound_between)
)";

std::string set(const char* name, study::Duration value) { return name + (" = " + exact_us(value)) + "\n"; }

}  // namespace

Picture plot_embedding(const PlotInput& input) {
  const study::Medium& medium = input.options.medium;
  const study::Latencies embedded = interrupt_round_trips(medium, true, input.options.seed);
  const study::Latencies between = interrupt_round_trips(medium, false, input.options.seed);
  std::vector<Column> columns{{"percent", {}}, {"embedded_us", {}}, {"between_us", {}}};
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    columns[0].cells.push_back(app::number(100 * share, 1));
    columns[1].cells.push_back(exact_us(embedded.quantile(share)));
    columns[2].cells.push_back(exact_us(between.quantile(share)));
  }
  const std::string count = std::to_string(embedded.count());
  return {"embedding", csv_of(columns),
          title(count + " interrupts while every node always has data to send", figures_of(input.options)) +
              set("least", embedded.min()) + set("bound_embedded", interrupt_bound(medium)) +
              set("bound_between", interrupt_bound_between_packets(medium)) + set("worst_embedded", embedded.max()) +
              set("worst_between", between.max()) + kEmbeddingPlot};
}

// ---- A packet hop by hop ----

namespace {

using study::Passing;

constexpr unsigned kMostLabels = 20;  // that fit beside the rows

/// Above the middle of a row what arrives, below it what leaves; in many rows bars are thinner than a
/// border, which would hide them.
constexpr const char* kAxes = R"(set xlabel 'Time since the start of sending, us'
set ylabel 'Node'
set xrange [0:1.03*back]
set yrange [rows-0.4:-0.6]
set grid xtics
set style fill solid 0.8 noborder
if (rows < 40) set style fill solid 0.8 border linecolor rgb 'white'
set key at graph 0.95, graph 0.98 right top
set arrow from back, graph 0 to back, graph 1 nohead front linetype 7
bar(kind, from, to) = strcol(1) eq kind ? (from + to) / 2 : NaN
)";

constexpr const char* kOurs = R"(plot file using (bar('ours', $5, $6)):2:5:6:($2-0.42):($2-0.03) \
    with boxxyerror linetype 6 dashtype 1 linewidth 1 title 'it arrives, header to tail', \
  file using (bar('ours', $7, $8)):2:7:8:($2+0.03):($2+0.42) \
    with boxxyerror linetype 1 dashtype 1 linewidth 1 title 'it leaves, header to tail', \
  NaN with lines linetype 7 title 'its tail is back')";

constexpr const char* kInFront = R"(, \
  file using (bar('own', $7, $8)):2:7:8:($2+0.03):($2+0.42) \
    with boxxyerror linetype 4 dashtype 1 linewidth 1 title "in front: the node's own", \
  file using (bar('relayed', $7, $8)):2:7:8:($2+0.03):($2+0.42) \
    with boxxyerror linetype 9 dashtype 1 linewidth 1 title 'in front: relayed')";

std::string labels(unsigned nodes) {
  const unsigned step = nodes / kMostLabels + 1;
  std::string text = "set ytics (";
  for (unsigned id = 0; id + step <= nodes; id += step)
    text += "'" + std::to_string(id) + "' " + std::to_string(id) + ", ";
  return text + "'0, back' " + std::to_string(nodes) + ")\n";
}

void put_span(std::vector<Column>& columns, std::size_t first, const std::optional<Passing::Span>& span) {
  columns[first].cells.push_back(span ? exact_us(span->header) : "");
  columns[first + 1].cells.push_back(span ? exact_us(span->tail) : "");
}

void put(std::vector<Column>& columns, const char* kind, unsigned row, const Passing& passing) {
  columns[0].cells.push_back(kind);
  columns[1].cells.push_back(std::to_string(row));
  columns[2].cells.push_back(std::to_string(passing.source));
  columns[3].cells.push_back(std::to_string(passing.hop));
  put_span(columns, 4, passing.arrives);
  put_span(columns, 6, passing.leaves);
}

std::string csv(const study::Timeline& timeline, const study::Medium& medium) {
  std::vector<Column> columns;
  for (const char* name :
       {"packet", "row", "source", "hop", "header_arrives_us", "tail_arrives_us", "header_leaves_us", "tail_leaves_us"})
    columns.push_back({name, {}});
  for (const Passing& passing : timeline.ours) put(columns, "ours", passing.hop, passing);
  for (const Passing& passing : timeline.in_front)
    put(columns, passing.hop == 0 ? "own" : "relayed", passing.node(medium), passing);
  return csv_of(columns);
}

Picture picture(const std::string& name, const std::string& what, const study::Timeline& timeline,
                const PlotInput& input) {
  const study::Medium& medium = input.options.medium;
  const study::Duration back = timeline.ours.back().arrives->tail;
  const std::string figures = "file = '" + name + ".csv'\nrows = " + std::to_string(medium.nodes + 1) +
                              "\nback = " + exact_us(back) + "\n" + labels(medium.nodes);
  return {name, csv(timeline, medium),
          title(what + " = " + app::number(study::microseconds(back), 3) + " us", figures_of(input.options)) + figures +
              kAxes + kOurs + (timeline.in_front.empty() ? "" : kInFront) + "\n"};
}

}  // namespace

Picture plot_timeline_alone(const PlotInput& input) {
  const study::Timeline timeline = timeline_alone(input.options.medium);
  return picture("timeline_alone", "A packet alone on the ring: back after T + N d", timeline, input);
}

Picture plot_timeline_worst(const PlotInput& input) {
  const study::Timeline timeline = timeline_worst(input.options.medium);
  return picture("timeline_worst", "Every node starts a packet just before ours arrives: back after N (T + d)",
                 timeline, input);
}

}  // namespace limb_ring::comparison
