#pragma once

#include <string>

#include "app/ringctl/ring_plan.h"
#include "scenario/scenario.h"

namespace limb_ring::ringctl {

/// The plan of a ring to play a scenario on: the scenario's own ring, but the CPU of every node is scenario_cpu,
/// which counts what it takes, and its name is one that no other ring has.
/// @param folder where its file is written
/// @param transport unix or udp, or empty as in UpRequest
/// @throw NotDone where scenario_cpu is not installed, or the file cannot be written
RingPlan plan_story_ring(const scenario::Scenario& scenario, const std::string& folder,
                         const std::string& transport);

}  // namespace limb_ring::ringctl
