#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/time.h"

namespace limb_ring::statistics {

double microseconds(core::Duration duration);

/// Nearest rank: the place, from 0 in ascending order, of the smallest value that `share` of all do not exceed.
/// @param share 0 to 1 @pre count > 0
std::size_t nearest_rank(std::size_t count, double share);

/// Exact percentiles of some durations, in microseconds.
struct Percentiles {
  double min = 0, p50 = 0, p99 = 0, max = 0;
  std::size_t samples = 0;
};
/// Reorders `samples`.
Percentiles percentiles(std::vector<core::Duration>& samples);

/// {"min","p50","p99","max","samples"}; null instead of numbers if there are no samples.
nlohmann::json to_json(const Percentiles& percentiles);

}  // namespace limb_ring::statistics
