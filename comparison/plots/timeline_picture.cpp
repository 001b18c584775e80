#include "comparison/measurements.h"

#include "comparison/plots/picture.h"
#include "study/model_ring.h"
#include "tools/common/text_table.h"

namespace limb_ring::comparison {

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
  columns[first].cells.push_back(span ? us(span->header) : "");
  columns[first + 1].cells.push_back(span ? us(span->tail) : "");
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
                              "\nback = " + us(back) + "\n" + labels(medium.nodes);
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
