#pragma once

#include <string>

namespace limb_ring::ringctl {

/// Path of scenario_cpu, the CPU of a node in a scenario with processes. @throw NotDone where it is not installed
std::string scenario_cpu();

}  // namespace limb_ring::ringctl
