#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

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

/// What the scenario does to a ring, and how often.
ScenarioSize size_of(const Scenario& scenario);
/// The same expectation is missed in the same way, numbers aside: counters and times differ in a smaller ring.
bool alike(const Unmet& one, const Unmet& other);

struct ShrinkRequest {
  std::string path;                   ///< of the scenario's file
  std::optional<std::string> text;    ///< instead of what is in that file
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

/// Of the steps of a scenario those, in their order, without which it is not missed alike: of thousands a few, before
/// shrink() looks closer. @param fails_alike runs a scenario with some of the steps
/// @return their numbers
std::vector<std::size_t> needed_steps(std::size_t count,
                                      const std::function<bool(const std::vector<std::size_t>&)>& fails_alike);

}  // namespace limb_ring::scenario
