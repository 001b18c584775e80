#pragma once

#include <string>
#include <vector>

#include "app/run_cli.h"
#include "tools/ring_sim/command_line.h"

namespace limb_ring::ring_sim {

inline CliRun ring_sim(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "ring_sim");
  return run_cli(run_command_line, std::move(arguments));
}

}  // namespace limb_ring::ring_sim
