#pragma once

#include <functional>
#include <optional>

#include "judge/violation.h"
#include "sim/invariants.h"
#include "sim/virtual_ring.h"

namespace limb_ring::sim {

/// Times and buffers of rings that are given faults: short and few, so that every limit is met soon.
/// @param paced lines have a rate
void set_short_times(core::Settings& settings, bool paced, bool fold_back);

/// Whether a slice counts as traffic: it does not belong to a beacon. The beginning of a packet never counts, since
/// only its end shows what it is.
bool is_traffic(const wire::Slice& slice);

/// Runs a ring in which all was mended until what is left over has ended: all nodes are up in a ring of them all, each
/// send has its result, and nothing but beacons has passed for ten of their periods, and for longer than the tries of a
/// send take. What does not end is for not_whole(), not_silent() and Invariants::finish() to tell.
/// @param traffic slices of it that were seen so far
/// @param asked_to_stop asked once in each millisecond of the ring's time; true: it runs no longer
void run_until_calm(
    VirtualRing& ring, const Invariants& invariants, const std::uint64_t& traffic,
    const std::function<bool()>& asked_to_stop = [] { return false; });

/// All was mended some time ago: nothing where all nodes are up in a ring of them all.
std::optional<Violation> not_whole(VirtualRing& ring);
/// Traffic has ended long ago: whatever still goes round, and is no beacon, would do so for ever.
/// @param slices of traffic that were seen since
std::optional<Violation> not_silent(const VirtualRing& ring, std::uint64_t slices);

}  // namespace limb_ring::sim
