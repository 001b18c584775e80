#pragma once

#include <string>
#include <vector>

#include "tools/ring_sim/command_line.h"
#include "tools/run_cli.h"

namespace limb_ring::ring_sim {

inline CliRun ring_sim(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "ring_sim");
  return run_cli(run_command_line, std::move(arguments));
}

}  // namespace limb_ring::ring_sim
