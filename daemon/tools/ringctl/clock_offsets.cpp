#include "tools/ringctl/clock_offsets.h"

namespace limb_ring::ringctl {

std::vector<ClockOffset> clock_offsets(const std::vector<std::optional<std::int64_t>>& latches_ns, std::size_t source,
                                       double round_trip_us, unsigned ring_size) {
  const double hop_us = ring_size > 0 ? round_trip_us / ring_size : 0.0;
  std::vector<ClockOffset> offsets(latches_ns.size());
  unsigned hops = 0;
  for (std::size_t step = 0; step < latches_ns.size(); ++step) {
    const std::size_t node = (source + step) % latches_ns.size();
    if (!latches_ns[node]) continue;  // bypassed, or its daemon is gone: no hop of its own
    const double apart_us = static_cast<double>(*latches_ns[node] - *latches_ns[source]) / 1000.0;
    offsets[node] = {hops, apart_us - hops * hop_us};
    ++hops;
  }
  return offsets;
}

}  // namespace limb_ring::ringctl
