#pragma once

#include <string>

#include "io/signal_wait.h"
#include "sim/scenario_run.h"

namespace limb_ring::ringctl {

/// Plays a scenario on live daemons, a ring of their own in a private folder; all have ended when this returns or
/// throws. @param transport unix, shm or udp, or empty: as the ring's file says
/// @throw Interrupted; NotDone where a program is missing; UsageError where a path is too long
scenario::ScenarioRun play_live(const scenario::Scenario& scenario, std::uint64_t seed, const std::string& transport,
                                process::SignalWait& signals);

}  // namespace limb_ring::ringctl
