#pragma once

#include <string>
#include <vector>

#include "app/ringctl/command/command_line.h"
#include "app/said.h"

namespace limb_ring::ringctl {

inline Said ringctl(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "ringctl");
  return said(run_command_line, std::move(arguments));
}

}  // namespace limb_ring::ringctl
