#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "scenario/scenario_run.h"

namespace limb_ring::scenario {

/// What a scenario does to a ring.
struct ScenarioSize {
  std::size_t faults = 0;
  std::uint64_t sends = 0;  ///< packets; of a send without end, one
};

struct Shrunk {
  std::string text;  ///< of the smaller scenario, YAML; its ring's file is named as seen from `beside`
  ScenarioRun run;   ///< what it does
  ScenarioSize before, after;
  std::size_t runs = 0;  ///< that were tried
};

struct ShrinkRequest {
  std::string path;                   ///< of the scenario's file
  std::optional<std::uint64_t> seed;  ///< instead of the file's own
  std::string beside = ".";           ///< folder where the smaller one is to lie
  /// Called after each run; throws to end it all.
  std::function<void(std::size_t runs)> tell = [](std::size_t) {};
};

/// Leaves out of a scenario whatever it is not as expected without: steps, nodes, entries; and makes its numbers
/// smaller. What remains misses the same expectation and shows the same instead, numbers aside, under the virtual
/// clock; what came too late still comes. (ours, after Zeller and Hildebrandt's delta debugging)
/// @return nothing where the scenario is as expected
/// @throw config::ConfigError, as load_scenario()
std::optional<Shrunk> shrink(const ShrinkRequest& request);

}  // namespace limb_ring::scenario
