#include "comparison/measurements.h"
#include "comparison/plots/picture.h"
#include "study/model_ring.h"
#include "tools/common/text_table.h"

namespace limb_ring::comparison {

namespace {

constexpr int kSteps = 500;  // of the distribution

// Ten times apart: on a logarithmic axis both can be read.
constexpr const char* kPlot = R"(set xlabel 'Round trip of an interrupt, request to return, us'
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

std::string set(const char* name, study::Duration value) { return name + (" = " + us(value)) + "\n"; }

}  // namespace

Picture plot_embedding(const PlotInput& input) {
  const study::Medium& medium = input.options.medium;
  const study::Latencies embedded = interrupt_round_trips(medium, true, input.options.seed);
  const study::Latencies between = interrupt_round_trips(medium, false, input.options.seed);
  std::vector<Column> columns{{"percent", {}}, {"embedded_us", {}}, {"between_us", {}}};
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    columns[0].cells.push_back(app::number(100 * share, 1));
    columns[1].cells.push_back(us(embedded.quantile(share)));
    columns[2].cells.push_back(us(between.quantile(share)));
  }
  const std::string count = std::to_string(embedded.count());
  return {"embedding", csv_of(columns),
          title(count + " interrupts while every node always has data to send", figures_of(input.options)) +
              set("least", embedded.min()) + set("bound_embedded", interrupt_bound(medium)) +
              set("bound_between", interrupt_bound_between_packets(medium)) + set("worst_embedded", embedded.max()) +
              set("worst_between", between.max()) + kPlot};
}

}  // namespace limb_ring::comparison
