#include "judge/percentiles.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace limb_ring::statistics {

double microseconds(core::Duration duration) { return std::chrono::duration<double, std::micro>(duration).count(); }

std::size_t nearest_rank(std::size_t count, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(count)));
  return std::min(count, std::max<std::size_t>(rank, 1)) - 1;
}

namespace {

double value_at(std::vector<core::Duration>& samples, double share) {
  const auto place = samples.begin() + static_cast<std::ptrdiff_t>(nearest_rank(samples.size(), share));
  std::nth_element(samples.begin(), place, samples.end());
  return microseconds(*place);
}

}  // namespace

Percentiles percentiles(std::vector<core::Duration>& samples) {
  if (samples.empty()) return {};
  Percentiles p;
  p.samples = samples.size();
  p.min = value_at(samples, 0.0);
  p.p50 = value_at(samples, 0.5);
  p.p99 = value_at(samples, 0.99);
  p.max = value_at(samples, 1.0);
  return p;
}

nlohmann::json to_json(const Percentiles& p) {
  const auto number = [&](double value) { return p.samples == 0 ? nlohmann::json() : nlohmann::json(value); };
  return {{"min", number(p.min)},
          {"p50", number(p.p50)},
          {"p99", number(p.p99)},
          {"max", number(p.max)},
          {"samples", p.samples}};
}

}  // namespace limb_ring::statistics
