#pragma once

#include <string>
#include <vector>

#include "sim/scenario.h"

namespace limb_ring::program_stage {

/// The program that is the CPU of a node for which the ring's file names none.
struct StandIn {
  std::string path;         ///< of scenario_cpu
  bool everywhere = false;  ///< also in place of those that the file names
};

/// What in a scenario is not possible on a virtual ring with real programs, and why; empty: it can be played there.
std::vector<std::string> not_with_programs(const scenario::Scenario& scenario);

/// Nodes whose program cannot be found, with what the file names: "knee: no program 'x' ..."; empty: all are there.
std::vector<std::string> missing_programs(const config::RingConfig& ring);

/// The scenario's ring with a program as the CPU of every node.
config::RingConfig ring_with_programs(const scenario::Scenario& scenario, const StandIn& stand_in, std::uint64_t seed);

}  // namespace limb_ring::program_stage
