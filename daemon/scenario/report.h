#pragma once

#include <string>
#include <vector>

#include "scenario/scenario_run.h"

namespace limb_ring::scenario {

/// For people: what was done and seen with its times, and the first unmet expectation.
std::string text_of(const ScenarioRun& run);

/// For build servers: JUnit XML, a test case per scenario. Its times are the scenarios' own.
std::string junit_of(const std::vector<ScenarioRun>& runs);

}  // namespace limb_ring::scenario
