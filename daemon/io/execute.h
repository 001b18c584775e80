#pragma once

#include <string>
#include <vector>

namespace limb_ring::process {

/// Turns this process into the program at `path`, with the same environment, pid and descriptors.
/// @param arguments including the program's name as the first
/// @return errno: it comes back only where the program cannot be executed
int execute(const std::string& path, std::vector<std::string> arguments);

}  // namespace limb_ring::process
