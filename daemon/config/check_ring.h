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

/// The first node whose line comes from another host and is neither keyed nor meant to be insecure, in words; empty
/// where there is none. Also for transports that the command line has changed.
std::string unkeyed_line(const RingConfig& ring);
extern const char* const kKeyOrInsecure;

}  // namespace limb_ring::config
