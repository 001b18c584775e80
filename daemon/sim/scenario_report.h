#pragma once

#include <string>
#include <vector>

#include "sim/scenario.h"
#include "sim/scenario_run.h"

namespace limb_ring::scenario {

/// For people: what was done and seen with its times, and the first unmet expectation.
std::string text_of(const ScenarioRun& run);

/// For build servers: JUnit XML, a test case per scenario. Its times are the scenarios' own.
/// @param scenarios all that were to be run, in this order; those that have no run count as skipped, the first of them
/// as an error
/// @param stopped why that one has no run
std::string junit_of(const std::vector<ScenarioRun>& runs, const std::vector<Scenario>& scenarios = {},
                     const std::string& stopped = {});

/// What in a scenario is not possible on live daemons, and why; empty: it can be played there.
/// @param transport of all lines, unix, shm or udp; empty: as the ring's file says
std::vector<std::string> only_virtual(const Scenario& scenario, const std::string& transport);

}  // namespace limb_ring::scenario
