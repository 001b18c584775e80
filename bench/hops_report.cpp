#include "hops_report.h"

#include <algorithm>
#include <cmath>

namespace limb_ring::hops {

namespace {

using app::Row;

using Rates = std::vector<double>;

/// More decimals would be noise.
Row two_decimals(double value) { return std::round(value * 100) / 100; }

Row best(const Rates& rates) {
  if (rates.empty()) return nullptr;
  return two_decimals(*std::max_element(rates.begin(), rates.end()) / 1e6);
}

Row median(std::vector<double> values) {
  if (values.empty()) return nullptr;
  std::sort(values.begin(), values.end());
  return two_decimals((values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2);
}

/// What a hop cost beside another's, round by round; the cost is one over the rate.
Row cost(const Rates& rates, const Rates& beside) {
  std::vector<double> ratios;
  for (std::size_t round = 0; round < rates.size(); ++round) ratios.push_back(beside[round] / rates[round]);
  return median(ratios);
}

Row row_of(const Series& series, const Series& first) {
  Row row;
  row["ring"] = series.name;
  for (std::size_t size = 0; size < kSizes.size(); ++size) {
    const std::string nodes = std::to_string(kSizes[size]);
    row["m_hops_s_" + nodes] = best(series.rates[size]);
    row["cost_" + nodes] = cost(series.rates[size], first.rates[size]);
  }
  row["growth"] = cost(series.rates.back(), series.rates.front());
  return row;
}

}  // namespace

std::vector<Row> report(const std::vector<Series>& all) {
  std::vector<Row> rows;
  for (const Series& series : all) rows.push_back(row_of(series, all.front()));
  return rows;
}

}  // namespace limb_ring::hops
