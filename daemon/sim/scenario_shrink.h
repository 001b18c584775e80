#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/scenario_run.h"

namespace limb_ring::scenario {

/// What a scenario does to a ring.
struct ScenarioSize {
  std::size_t faults = 0;
  std::uint64_t sends = 0;  ///< packets; of a send without end, one
};

/// A failing scenario made smaller.
struct Shrunk {
  std::string text;  ///< of the smaller scenario, YAML; its ring's file is named as seen from `beside`
  ScenarioRun run;   ///< what it does
  ScenarioSize before, after;
  std::size_t runs = 0;  ///< that were tried
  bool stopped = false;  ///< after `most_runs`: it could be smaller
};

/// What the scenario does to a ring, and how often.
ScenarioSize size_of(const Scenario& scenario);
/// "3 faults and 40 sends"
std::string in_words(const ScenarioSize& size);
/// Both miss the same expectation in the same way. Numbers are ignored: counters and times differ in a smaller ring.
bool alike(const Unmet& one, const Unmet& other);

/// Far more runs than failures have needed so far. One exception had not ended by then: everything in it mattered.
constexpr std::size_t kMostShrinkingRuns = 5000;

/// Which scenario shrink() is to make smaller, and how hard to try.
struct ShrinkRequest {
  std::string path;                   ///< of the scenario's file
  std::optional<std::string> text;    ///< instead of what is in that file
  std::optional<std::uint64_t> seed;  ///< instead of the file's own
  std::string beside = ".";           ///< folder where the smaller one is to lie
  std::size_t most_runs = kMostShrinkingRuns;
  /// Called after each run; throws to end it all.
  std::function<void(std::size_t runs)> tell = [](std::size_t) {};
};

/// Makes a failing scenario smaller: leaves out all steps, nodes and entries that it fails without, and makes its
/// numbers smaller. The result fails alike() under the virtual clock; an expectation that was met too late is still
/// met too late. (ours, after Zeller and Hildebrandt's delta debugging)
/// @return nothing if the scenario does not fail
/// @throw config::ConfigError, as load_scenario()
std::optional<Shrunk> shrink(const ShrinkRequest& request);

/// The steps without which a scenario no longer fails alike: a few out of thousands, before shrink() looks closer.
/// @param count of its steps
/// @param most_runs of fails_alike()
/// @param fails_alike runs the scenario with only these steps @return the numbers of the needed steps, in order
std::vector<std::size_t> needed_steps(std::size_t count, std::size_t most_runs,
                                      const std::function<bool(const std::vector<std::size_t>&)>& fails_alike);

}  // namespace limb_ring::scenario
