#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace limb_ring::bridge {

/// What RunScenario.srv asks for.
struct ScenarioOrder {
  std::string path, text;               ///< one of them
  bool live = false, programs = false;  ///< not both
  std::uint64_t seed = 0;               ///< 0: the file's own
};

struct ScenarioEnd {
  int exit_code = 0;  ///< of ringctl
  std::string report, junit;
};

/// Plays a scenario in a ringctl of its own and waits until it has ended. Blocks.
/// @param go_on asked many times a second; where it says no, the run is interrupted as by Ctrl-C
/// @throw std::invalid_argument where not exactly one of path and text is given, or both live and programs;
///        std::runtime_error where ringctl cannot be started
ScenarioEnd play_scenario(const ScenarioOrder& order, const std::function<bool()>& go_on);

}  // namespace limb_ring::bridge
