#pragma once

#include <string>
#include <vector>

#include "sim/scenario.h"

namespace limb_ring::scenario {

/// What in a scenario is not possible on live daemons, and why; empty: it can be played there.
/// @param transport of all lines, unix, shm or udp; empty: as the ring's file says
std::vector<std::string> only_virtual(const Scenario& scenario, const std::string& transport);

}  // namespace limb_ring::scenario
