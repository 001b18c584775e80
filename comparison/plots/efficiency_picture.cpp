#include "comparison/plots/picture.h"
#include "tools/common/text_table.h"

namespace limb_ring::comparison {

namespace {

// The ideal comes first, below what reaches it.
constexpr const char* kPlot = R"(set xlabel 'Payload offered, % of R'
set ylabel 'Payload delivered, % of R'
set xrange [0:104]
set yrange [0:104]
set grid
set key top left
plot x with lines linetype 7 title 'ideal: all that is offered', \
  for [k=2:columns] 'efficiency.csv' using 1:k with linespoints linetype k-1 title columnheader(k)
)";

std::string percent(double share) { return app::number(100 * share, 3); }

}  // namespace

Picture plot_efficiency(const PlotInput& input) {
  std::vector<Column> columns{{"offered_percent", {}}};
  for (const double load : input.options.loads) columns.front().cells.push_back(percent(load));
  for (const study::LoadPoint& point : input.comparison.against_load)
    if (!point.subject.own_rate) add_point(columns, point.subject.method, percent(point.delivered));
  return {"efficiency", csv_of(columns),
          title("Efficiency under random load", figures_of(input.options)) +
              "columns = " + std::to_string(columns.size()) + "\n" + kPlot};
}

}  // namespace limb_ring::comparison
