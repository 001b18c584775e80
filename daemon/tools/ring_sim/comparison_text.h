#pragma once

#include <string>

#include "study/comparison/comparison.h"

namespace limb_ring::ring_sim {

/// The comparison for people: a table for each question, grouped by rate, at most 100 columns wide
/// with up to 10 loads and 10 numbers of nodes.
std::string comparison_text(const study::Comparison& comparison, const study::ComparisonOptions& options);

}  // namespace limb_ring::ring_sim
