#pragma once

#include <memory>

#include "config/ring_config.h"
#include "sim/watched_ring.h"

namespace limb_ring::study {

/// The ring of a file under a virtual clock: every core as setup::core_settings() has it, but for the ids,
/// which are the places in ring order. Each line has its own rate and delay.
/// @param ring every line has a rate; outlives the result
std::unique_ptr<sim::WatchedRing> planned_ring(const config::RingConfig& ring);

}  // namespace limb_ring::study
