#pragma once

#include <optional>

#include "io/program.h"
#include "io/signal_wait.h"
#include "ring/launched_ring.h"
#include "tools/ringctl/ring_plan.h"
#include "tools/ringctl/ring_watch.h"
#include "tools/ringctl/up_lock.h"

namespace limb_ring::ringctl {

/// Says that the ring, or this host's part of it, is up; of a part that is refused by the others, why.
void announce(const RingPlan& plan, RingWatch& watch);

/// A second request to end kills at once.
void end(live::LaunchedRing& daemons, process::SignalWait& signals);

/// Saves recordings when something goes wrong, where the ring's file says so; ends with the ring.
/// @param lifetime its own: it writes into keep.log in the ring's folder
std::optional<process::Program> start_keeper(const RingPlan& plan, process::Lifetime lifetime);

/// Until a signal, or until all daemons have ended by themselves (ringctl down).
/// @param has_end the ring ends when its time is over; its folder goes then, unless 'ringctl down' has removed it
/// @return an ExitCode
int stay(const RingPlan& plan, live::LaunchedRing& daemons, process::SignalWait& signals, bool has_end);

/// Starts the ring and stays until a signal, whatever ends the daemons. @return an ExitCode
/// @throw NotDone where one cannot start
int respawn(const RingPlan& plan, UpLock& lock);

}  // namespace limb_ring::ringctl
