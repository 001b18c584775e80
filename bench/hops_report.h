#pragma once

#include <array>
#include <string>
#include <vector>

#include "load.h"
#include "tools/common/text_table.h"

namespace limb_ring::hops {

/// What one way of doing the ring reached.
struct Series {
  std::string name;
  std::array<std::vector<double>, kSizes.size()> rates;  ///< packet-hops/s, one a round; none: not measured
};

/// A row for each series: per size the best rate in millions (a disturbance only ever slows) and
/// what a hop cost beside the first series'; and how a hop's cost grew from the first size to the
/// last. Both ratios are medians over the rounds of what was measured in the same round, so that a
/// disturbance of the machine is in both sides of them.
/// @pre `all` is not empty; a series has as many rounds as the first, or none
std::vector<app::Row> report(const std::vector<Series>& all);

}  // namespace limb_ring::hops
