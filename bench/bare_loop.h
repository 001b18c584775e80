#pragma once

#include <cstdint>

namespace limb_ring::hops {

/// The same ring with no protocol: a heap of events, one per hop, each with the two copies of the
/// packet and the CRC check that no relay can do without.
/// @return packet-hops per second of wall-clock time
double bare_loop(unsigned nodes, std::uint64_t hops);

constexpr const char* kBareLoop =
    "bare loop: per hop a heap event, two copies and a CRC check; no slices, queues, returns, time-outs or results";

}  // namespace limb_ring::hops
