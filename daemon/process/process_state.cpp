#include "process/process_state.h"

#include <fstream>
#include <iterator>
#include <string>

namespace limb_ring::process {

// The program's name before it, in brackets, may hold any character.
char process_state(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t state = text.rfind(')');
  return state == std::string::npos || state + 2 >= text.size() ? '\0' : text[state + 2];
}

}  // namespace limb_ring::process
