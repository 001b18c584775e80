#pragma once

#include "config/ring_config.h"

namespace limb_ring::runtime {

/// The core of the node at `place` in a ring of `nodes`, out of those that are `allowed`: as many neighbours as
/// possible share one, so that few packets wake another core. @pre place < nodes, some are allowed
unsigned core_of(std::size_t place, std::size_t nodes, const std::vector<unsigned>& allowed);

/// Pins this process to cores, asks for SCHED_FIFO and locks its memory, as the configuration
/// says. Where the rights are missing it says so once, with what would give them, and goes on.
/// @param place of this node in ring order
void apply_realtime(const config::RingConfig& ring, std::size_t place);

/// Pins this process, which holds a whole virtual ring, and the CPUs that it starts to the core it is on: they act one
/// after the other, and to wake another core costs more than what most of them do. `realtime.cores`, a list, is obeyed
/// instead.
void keep_on_one_core(const config::RingConfig& ring);

}  // namespace limb_ring::runtime
