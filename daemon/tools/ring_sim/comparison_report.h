#pragma once

#include <string>

#include "study/comparison/comparison.h"
#include "tools/common/rows.h"

namespace limb_ring::ring_sim {

/// The comparison for people (tables in groups, at most 100 columns), as one JSON object (the
/// options, and an array for each vector of study::Comparison), or as CSV with one value in a row.
/// Times in us, rates in Mbit/s. @param options what it was made with
std::string format_comparison(const study::Comparison& comparison, const study::ComparisonOptions& options,
                              app::Format format);

}  // namespace limb_ring::ring_sim
