#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace limb_ring::ringctl {

/// One node's clock beside the source's, after a sync interrupt. (paper: synchronization between
/// CPUs by a broadcast interrupt; the arithmetic is ours)
struct ClockOffset {
  unsigned hops = 0;                ///< downstream of the source, living nodes only
  std::optional<double> offset_us;  ///< positive: its clock is ahead; empty: it did not latch
};

/// Offsets of all nodes in ring order: latch time, less the source's, less the time the interrupt
/// took to come there, which is hops * round trip / ring size.
/// @param latches_ns clock of each node in ring order when its sync pin was pulled (of the source:
///        when it sent); empty if the node did not latch
/// @param source index of the source; its latch is there
std::vector<ClockOffset> clock_offsets(const std::vector<std::optional<std::int64_t>>& latches_ns, std::size_t source,
                                       double round_trip_us, unsigned ring_size);

}  // namespace limb_ring::ringctl
