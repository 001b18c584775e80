#pragma once

#include <string>

#include "config/entry.h"
#include "config/quantity.h"
#include "config/ring_config.h"

namespace limb_ring::config {

/// Reads the YAML file of one ring. What is not in it has its default (config/OPTIONS.md).
/// @throw ConfigError if the file is not readable, above 1 MiB or not YAML; else for every entry that is unknown or
///        of a wrong type or range, a line each; and if none is, for all entries that contradict each other.
RingConfig load_ring(const std::string& path);

/// The same for YAML in memory. `name` stands for the file in errors.
/// @throw ConfigError
RingConfig parse_ring(const std::string& text, const std::string& name);

/// Refuses what no single entry shows: entries that contradict each other.
/// @param file the whole file, for the place of what is wrong
/// @throw ConfigError
void check_ring(const Entry& file, const RingConfig& ring);
/// The part of it that concerns `hosts`.
void check_hosts(const Entry& file, const RingConfig& ring);

/// The first node whose line comes from another host and is neither keyed nor meant to be insecure, in words; empty
/// if there is none. Also for transports that the command line has changed.
std::string unkeyed_line(const RingConfig& ring);
extern const char* const kKeyOrInsecure;

}  // namespace limb_ring::config
