#pragma once

#include "sim/virtual_ring.h"
#include "study/analysis/medium.h"

/// The ring of the paper's model (protocol.md section 7.2): our core on a medium, without what that model lacks.
namespace limb_ring::study {

/// A virtual ring on that medium, beacons off. Its time-outs are those of the model, two worst laps; it
/// meets no other limit. (ours)
sim::VirtualRingOptions ring_options(const Medium& medium);

/// Runs until every living node has joined. @throw std::runtime_error where the ring does not close
void join(sim::VirtualRing& ring);

/// The same, and until the line is quiet again.
void join_and_settle(sim::VirtualRing& ring, const Medium& medium);

}  // namespace limb_ring::study
