#pragma once

#include "study/cases.h"
#include "tools/common/text_table.h"

namespace limb_ring::ring_sim {

/// What each case is, for --help.
constexpr const char* kCasesHelp =
    "Cases (N nodes; T: time of a packet on a line; i: that of an INTP; d: relay delay):\n"
    "  alone: one packet, nobody else sends; T + N d\n"
    "  simultaneous: all nodes start to send at the same instant; N T + d\n"
    "  adversarial: each node starts to send just before this packet arrives there; N (T + d)\n"
    "  request: the same, asked for just after a packet of another began to pass; (N + 1) T + N d\n"
    "  delivery: adversarial, but only as far as the farthest node; (N - 1) (T + d)\n"
    "  interrupt: an INTP that meets one other INTP at every node; N (d + i)\n"
    "  interrupt_bound: the worst INTP that was seen while all nodes send; at most N (d + i + 8 bytes)\n"
    "  saturated: all nodes always send, in step; how much of the time the lines are in use\n"
    "  random: all nodes always send, from random instants on; at most N (T + d)\n"
    "  payload: all nodes always send; how much of what is on the lines is data";

/// "saturated, 16 nodes, 512 bytes"
std::string case_words(study::Case which, const study::Medium& medium);

/// One case as `table` prints it: case, nodes, payload, rate_bps, relay_delay_ns, formula in words,
/// formula_us and measured_us (the worst; null for shares), their difference, and the same of
/// shares in percent (null for times).
app::Row case_row(study::Case which, const study::Medium& medium, const study::CaseResult& result);

/// The same with min, mean, p99, max, occupancy, seed and trace hash, as `run` prints it.
app::Row run_row(study::Case which, const study::Medium& medium, const study::CaseResult& result, std::uint64_t seed);

}  // namespace limb_ring::ring_sim
