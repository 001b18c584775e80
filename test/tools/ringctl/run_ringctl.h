#pragma once

#include <string>
#include <vector>

#include "tools/ringctl/command_line.h"
#include "tools/run_cli.h"

namespace limb_ring::ringctl {

inline CliRun ringctl(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "ringctl");
  return run_cli(run_command_line, std::move(arguments));
}

}  // namespace limb_ring::ringctl
