#pragma once

#include <memory>

#include "config/ring_config.h"
#include "sim/watched_ring.h"

namespace limb_ring::sim {

/// What a line is taken for where nothing else is said. (ours)
constexpr std::uint64_t kUsualRate = 1'000'000'000;        ///< bit/s
constexpr std::chrono::nanoseconds kUsualRelayDelay{512};  ///< d: line and node

/// Rate and delay for lines of which the file gives no rate.
/// @param rate bit/s @return the ring with every line's rate given
config::RingConfig with_assumed_lines(config::RingConfig ring, std::uint64_t rate, std::chrono::nanoseconds delay);
/// Whether there is a line without a rate.
bool assumes_lines(const config::RingConfig& ring);

/// The ring of a file under a virtual clock: every core as setup::core_settings() has it, but for the ids,
/// which are the places in ring order. Each line has its own rate and delay.
/// @param ring every line has a rate; outlives the result
std::unique_ptr<WatchedRing> planned_ring(const config::RingConfig& ring);

}  // namespace limb_ring::sim
