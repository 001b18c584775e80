#include "tools/ringctl/virtual/scenario_cpu.h"

#include "io/find_program.h"
#include "tools/ringctl/problems.h"

namespace limb_ring::ringctl {

std::string scenario_cpu() {
  const std::string program = process::find_program("scenario_cpu");
  if (program.empty())
    throw NotDone("no program scenario_cpu beside ringctl (" + process::own_folder() + ") or on PATH");
  return program;
}

}  // namespace limb_ring::ringctl
