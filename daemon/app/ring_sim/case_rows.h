#pragma once

#include "app/common/rows.h"
#include "study/analysis/cases.h"

namespace limb_ring::ring_sim {

/// "saturated, 16 nodes, 512 bytes"
std::string case_words(study::Case which, const study::Medium& medium);

/// One case as `table` prints it: case, nodes, payload, rate_bps, relay_delay_ns, formula in words,
/// formula_us and measured_us (the worst; null for shares), their difference, and the same of
/// shares in percent (null for times).
app::Row case_row(study::Case which, const study::Medium& medium, const study::CaseResult& result);

/// The same with min, mean, p99, max, occupancy, seed and trace hash, as `run` prints it.
app::Row run_row(study::Case which, const study::Medium& medium, const study::CaseResult& result, std::uint64_t seed);

}  // namespace limb_ring::ring_sim
