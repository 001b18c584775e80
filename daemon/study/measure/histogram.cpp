#include "study/measure/histogram.h"

#include <algorithm>

namespace limb_ring::study {

namespace {

std::int64_t bin_of(Duration value, Duration width) { return (value - Duration{1}) / width; }

}  // namespace

std::vector<Bin> histogram(const std::vector<Duration>& values, Duration width) {
  if (values.empty()) return {};
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  const std::int64_t first = bin_of(*least, width), last = bin_of(*greatest, width);
  std::vector<Bin> bins;
  for (std::int64_t i = first; i <= last; ++i) bins.push_back({i * width, (i + 1) * width, 0});
  for (const Duration value : values) ++bins[static_cast<std::size_t>(bin_of(value, width) - first)].count;
  return bins;
}

}  // namespace limb_ring::study
