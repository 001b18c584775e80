#include "comparison/measurements.h"
#include "comparison/plots/picture.h"
#include "study/model_ring.h"
#include "tools/common/text_table.h"

namespace limb_ring::comparison {

namespace {

constexpr double kOfSaturation = 0.95;
constexpr int kBinsToBound = 75;

// The few that come near the bound matter most, so the axis is logarithmic.
constexpr const char* kPlot = R"(set xlabel 'Round trip, start of sending to tail back, us'
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

std::string percent(std::size_t count, const study::Latencies& all) {
  return app::number(100.0 * static_cast<double>(count) / static_cast<double>(all.count()), 6);
}

Picture picture(const study::Latencies& all, const std::vector<study::Bin>& bins) {
  std::vector<Column> columns{{"from_us", {}}, {"to_us", {}}, {"packets", {}}, {"percent", {}}};
  for (const study::Bin& bin : bins) {
    columns[0].cells.push_back(us(bin.from));
    columns[1].cells.push_back(us(bin.to));
    columns[2].cells.push_back(std::to_string(bin.count));
    columns[3].cells.push_back(percent(bin.count, all));
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
  Picture out = picture(all, study::histogram(all.values(), width));
  const std::string what = "Round trips of " + std::to_string(all.count()) + " packets under random load of " +
                           app::number(100 * load, 1) + " % of R, worst " +
                           app::number(study::microseconds(all.max()), 3) + " us";
  out.script = title(what, figures_of(input.options)) + "bound = " + us(bound) + "\n" + "one = " + percent(1, all) +
               "\n" + kPlot;
  return out;
}

}  // namespace limb_ring::comparison
