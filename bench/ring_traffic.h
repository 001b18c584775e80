#pragma once

#include "bench/measurement.h"
#include "bench/private_ring.h"

namespace limb_ring::bench {

/// Data packets made and timed in the daemons, from first byte out to matched return, each node
/// keeping one outstanding, to the node on the other side of the ring.
Measurement measure_traffic(const Setup& setup, const PrivateRing& ring, Sending sending);

}  // namespace limb_ring::bench
