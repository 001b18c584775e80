#pragma once

#include <string>

#include "config/config_error.h"
#include "config/ring_config.h"

namespace limb_ring::config {

/// Reads the YAML file of one ring. What is not in it has its default (config/OPTIONS.md).
/// @throw ConfigError for the first thing that is wrong: file not readable or above 1 MiB, not
///        YAML, an unknown entry, a wrong type or range, entries that contradict each other.
RingConfig load_ring(const std::string& path);

/// The same for YAML in memory. `name` stands for the file in errors.
/// @throw ConfigError
RingConfig parse_ring(const std::string& text, const std::string& name);

}  // namespace limb_ring::config
