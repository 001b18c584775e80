#pragma once

#include <string>

#include "config/quantity.h"
#include "sim/scenario.h"

namespace limb_ring::scenario {

/// Reads the YAML file of one scenario; docs/reference/scenarios.md lists what may stand in it.
/// @throw config::ConfigError for all that is wrong, a line each, with file, line and what is allowed; also for the
///        ring's file
Scenario load_scenario(const std::string& path);

/// The same for YAML in memory. `name` stands for the file, also if a ring's file is looked for beside it.
/// @throw config::ConfigError
Scenario parse_scenario(const std::string& text, const std::string& name);

}  // namespace limb_ring::scenario
