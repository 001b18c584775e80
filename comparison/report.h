#pragma once

#include <string>

#include "comparison/comparison.h"
#include "tools/common/text_table.h"

namespace limb_ring::comparison {

/// The comparison for people (tables in groups, at most 100 columns), as one JSON object (the
/// options, and an array for each vector of study::Comparison), or as CSV with one value in a row.
/// Times in us, rates in Mbit/s. @param options what it was made with
std::string format_comparison(const study::Comparison& comparison, const study::ComparisonOptions& options,
                              app::Format format);

/// The comparison for people: a table for each question, grouped by rate, at most 100 columns wide
/// with up to 10 loads and 10 numbers of nodes.
std::string comparison_text(const study::Comparison& comparison, const study::ComparisonOptions& options);

}  // namespace limb_ring::comparison
