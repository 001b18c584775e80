#pragma once

#include <string>
#include <vector>

#include "app/run_cli.h"
#include "tools/ringctl/command_line.h"

namespace limb_ring::ringctl {

inline CliRun ringctl(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "ringctl");
  return run_cli(run_command_line, std::move(arguments));
}

}  // namespace limb_ring::ringctl
