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
/// faults at the same instants. @pre the run has kept its history, and broken a promise
std::string scenario_of(const RandomFaults& run, std::uint64_t seed);
/// The same with only these of its steps, by number in that scenario.
std::string scenario_of(const RandomFaults& run, std::uint64_t seed, const std::vector<std::size_t>& steps);

/// What a seed has done until a promise was broken, as a story whose cause can be looked for. In futures above 1 all is
/// drawn by other seeds. @pre as scenario_of() @return nothing if the scenario does not fail as the seed did
std::unique_ptr<scenario::Story> story_of(const RandomFaults& run, std::uint64_t seed, FoldingRings folding);

/// scenario_of() made as small as possible: fewer steps first, then fewer nodes, then as scenario::shrink() does.
/// @param tell called after each run, with their number; throws to end it all
/// @return nothing if the scenario does not fail as the seed did
std::optional<scenario::Shrunk> shrunk_soak(const RandomFaults& run, std::uint64_t seed,
                                            const std::function<void(std::size_t runs)>& tell);

}  // namespace limb_ring::study
