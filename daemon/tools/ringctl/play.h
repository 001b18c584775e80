#pragma once

#include <ostream>
#include <string>

#include "io/signal_wait.h"
#include "sim/scenario_run.h"

namespace limb_ring::ringctl {

/// Plays a scenario on live daemons, a ring of their own in a private folder; all have ended when this returns or
/// throws. @param transport unix, shm or udp, or empty: as the ring's file says
/// @throw Interrupted; NotDone if a program is missing; UsageError if a path is too long
scenario::ScenarioRun play_live(const scenario::Scenario& scenario, std::uint64_t seed, const std::string& transport,
                                process::SignalWait& signals);

/// How a scenario is played on a virtual ring with real programs.
struct VirtualPlay {
  bool scenario_cpus = false;  ///< scenario_cpu at all nodes, also if the ring's file names a program
  std::string log;  ///< what the programs print and the nodes log is added to this file; empty: it is not kept
  std::ostream* capture = nullptr;  ///< packets as pcapng, or null; taken where `at` says
  sim::CaptureAt at = sim::CaptureAt::inputs;
  std::string* log_problem = nullptr;  ///< gets what of the log could not be written, and why; or null
};

/// @throw UsageError if the log cannot be written, it cannot be played so, or a program of the ring's file is
/// missing; NotDone if scenario_cpu is
void require_virtual(const scenario::Scenario& scenario, const VirtualPlay& play);

/// Plays it, its sockets in a private folder; all programs have ended when this returns or throws.
/// @param signals come to the ring while there is one: it ends by them
/// @pre require_virtual() @throw std::runtime_error if it is interrupted, or a socket cannot be had
scenario::ScenarioRun play_virtual(const scenario::Scenario& scenario, std::uint64_t seed, const VirtualPlay& play,
                                   const process::SignalWait& signals);

/// Of Ctrl-C, which is held back so that what was found is reported. @throw Interrupted
void throw_if_interrupted(const process::SignalWait& signals);

/// Path of scenario_cpu, the CPU of a node in a scenario with processes. @throw NotDone if it is not installed
std::string scenario_cpu();

}  // namespace limb_ring::ringctl
