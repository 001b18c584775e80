#include "io/execute.h"

#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace limb_ring::process {

int execute(const std::string& path, std::vector<std::string> arguments) {
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  ::signal(SIGXFSZ, SIG_DFL);  // outlive_file_limit() was for this program
  ::execv(path.c_str(), pointers.data());
  return errno;
}

}  // namespace limb_ring::process
