#include "runtime/re_exec.h"

#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include "process/spawn.h"

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
  std::vector<std::string> arguments = own_command_line();
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  process::close_descriptors_on_exec();
  if (cores) ::sched_setaffinity(0, sizeof *cores, &*cores);
  ::execv("/proc/self/exe", pointers.data());
  throw std::system_error(errno, std::generic_category(), "cannot execute this program again");
}

}  // namespace limb_ring::runtime
