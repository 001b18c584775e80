#include "node/re_exec.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include "io/execute.h"
#include "io/spawn.h"

namespace limb_ring::runtime {
namespace {

std::vector<std::string> own_command_line() {
  std::ifstream file("/proc/self/cmdline");
  std::vector<std::string> arguments;
  for (std::string argument; std::getline(file, argument, '\0');) arguments.push_back(argument);
  return arguments;
}

}  // namespace

void re_exec(const std::optional<cpu_set_t>& cores) {
  const std::vector<std::string> arguments = own_command_line();
  process::close_descriptors_on_exec();
  if (cores) ::sched_setaffinity(0, sizeof *cores, &*cores);
  const int error = process::execute("/proc/self/exe", arguments);
  spdlog::critical("ends: cannot execute this program again: {}", std::generic_category().message(error));
  ::_exit(1);  // as by kill -9: its CPU is gone already
}

}  // namespace limb_ring::runtime
