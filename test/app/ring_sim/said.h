#pragma once

#include <string>
#include <vector>

#include "app/ring_sim/command_line.h"
#include "app/said.h"

namespace limb_ring::ring_sim {

inline Said ring_sim(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "ring_sim");
  return said(run_command_line, std::move(arguments));
}

}  // namespace limb_ring::ring_sim
