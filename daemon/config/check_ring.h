#pragma once

#include "config/entry.h"
#include "config/ring_config.h"

namespace limb_ring::config {

/// Refuses what no single entry shows: entries that contradict each other.
/// @param file the whole file, for the place of what is wrong
/// @throw ConfigError
void check_ring(const Entry& file, const RingConfig& ring);
/// The part of it that concerns `hosts`.
void check_hosts(const Entry& file, const RingConfig& ring);

}  // namespace limb_ring::config
