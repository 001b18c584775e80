#pragma once

#include "bench/private_ring.h"

namespace limb_ring::bench {

/// What a ring takes that has nothing to do but what its configuration makes it do: percent of one
/// core, all its processes together, daemons and CPUs. Where the first node's CPU is attached, one
/// that only reads takes its place (and is not counted).
double measure_idle_percent(const Setup& setup, PrivateRing& ring);

}  // namespace limb_ring::bench
