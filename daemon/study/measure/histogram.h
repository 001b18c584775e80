#pragma once

#include <vector>

#include "study/analysis/latency.h"

namespace limb_ring::study {

/// How many values lie above `from` and not above `to`.
struct Bin {
  Duration from{0}, to{0};
  std::size_t count = 0;
};

/// Bins of one width without gaps, from the bin of the smallest value to that of the greatest; all limits are
/// multiples of the width. Empty if there are no values.
/// @param values above zero
/// @param width above zero
std::vector<Bin> histogram(const std::vector<Duration>& values, Duration width);

}  // namespace limb_ring::study
