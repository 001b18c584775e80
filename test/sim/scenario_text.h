#pragma once

#include <gmock/gmock.h>

#include <string>

#include "sim/load_scenario.h"
#include "sim/scenario_report.h"

namespace limb_ring::scenario {

/// A scenario on four plain nodes at 1 Gbit/s with d = 512 ns. Its own two lines come first.
inline std::string four_nodes(const std::string& more) { return "scenario: a test\nnodes: 4\n" + more; }

inline ScenarioRun run_of(const std::string& more) {
  const Scenario scenario = parse_scenario(four_nodes(more), "test.yaml");
  return run_scenario(scenario, scenario.seed);
}

/// "EXPECTED; SEEN" of what was not met, empty if all was.
inline std::string unmet_of(const std::string& more) {
  const ScenarioRun run = run_of(more);
  return run.unmet ? run.unmet->expected + "; " + run.unmet->seen : "";
}

/// What the loader says of a text that it refuses; empty if it takes it.
inline std::string refusal_of(const std::string& text) {
  try {
    parse_scenario(text, "test.yaml");
    return {};
  } catch (const config::ConfigError& error) {
    return error.what();
  }
}

}  // namespace limb_ring::scenario
