#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "sim/scenario_cause.h"
#include "sim/scenario_shrink.h"
#include "study/random_faults.h"

namespace limb_ring::study {

/// Small enough to be understood: at most 3 faults and 10 sends. Most seeds shrink to that. If more is left, each step
/// only moves another one by some nanoseconds, and another seed shows the same with fewer steps.
bool is_small(const scenario::ScenarioSize& size);

/// What a seed has done to its ring until a promise was broken, as a scenario of the soak's world: the same sends and
/// faults at the same instants. @pre the run is of the usual world, has kept its history, and broken a promise
std::string scenario_of(const RandomFaults& run);
/// The same with only these of its steps, by number in that scenario.
std::string scenario_of(const RandomFaults& run, const std::vector<std::size_t>& steps);

/// What a seed has done until a promise was broken, as a story whose cause can be looked for. Its events have the
/// numbers of the steps of scenario_of(). In futures above 1 all is drawn by other seeds.
/// @param run of any world, has kept its history and broken a promise, and outlives the story
/// @return nothing if the same steps, done once more, do not break it
std::unique_ptr<scenario::Story> story_of(const RandomFaults& run);

/// scenario_of() made as small as possible: fewer steps first, then fewer nodes, then as scenario::shrink() does.
/// @param tell called after each run, with their number; throws to end it all
/// @return nothing if the scenario does not fail as the seed did
std::optional<scenario::Shrunk> shrunk_soak(const RandomFaults& run, const std::function<void(std::size_t runs)>& tell);

}  // namespace limb_ring::study
