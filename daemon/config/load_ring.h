#pragma once

#include <string>

#include "config/config_error.h"
#include "config/ring_config.h"

namespace limb_ring::config {

/// Reads the YAML file of one ring. What is not in it has its default (config/OPTIONS.md).
/// @throw ConfigError where the file is not readable, above 1 MiB or not YAML; else for every entry that is unknown or
///        of a wrong type or range, a line each; and where none is, for all entries that contradict each other.
RingConfig load_ring(const std::string& path);

/// The same for YAML in memory. `name` stands for the file in errors.
/// @throw ConfigError
RingConfig parse_ring(const std::string& text, const std::string& name);

}  // namespace limb_ring::config
