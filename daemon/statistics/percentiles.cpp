#include "statistics/percentiles.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace limb_ring::statistics {

double microseconds(core::Duration duration) { return std::chrono::duration<double, std::micro>(duration).count(); }

namespace {

/// Nearest rank: the smallest sample that `share` of all do not exceed.
double rank(std::vector<core::Duration>& samples, double share) {
  const auto wanted = static_cast<std::size_t>(share * static_cast<double>(samples.size() - 1) + 0.5);
  const auto place = samples.begin() + static_cast<std::ptrdiff_t>(wanted);
  std::nth_element(samples.begin(), place, samples.end());
  return microseconds(*place);
}

}  // namespace

Percentiles percentiles(std::vector<core::Duration>& samples) {
  if (samples.empty()) return {};
  Percentiles p;
  p.samples = samples.size();
  p.min = rank(samples, 0.0);
  p.p50 = rank(samples, 0.5);
  p.p99 = rank(samples, 0.99);
  p.max = rank(samples, 1.0);
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
