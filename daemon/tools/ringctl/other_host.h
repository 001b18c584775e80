#pragma once

#include <string>
#include <vector>

#include "tools/ringctl/problems.h"

namespace limb_ring::ringctl {

/// Runs the same command line on the host that can do it, by ssh without prompts (BatchMode). It runs in the folder of
/// the same name, if there is one, with the ringctl of the same path, else the one on PATH. Its output and exit code
/// become ours; kNoRing if ssh cannot reach the host.
/// @param arguments without the program's name and without --ssh
/// @return an ExitCode, only where ssh cannot be started
int run_there(const Elsewhere& where, const std::vector<std::string>& arguments);

/// What is asked of the ringctl there: these, and the ring's name where they do not say it.
std::vector<std::string> arguments_there(const std::string& ring, std::vector<std::string> arguments);

/// What the shell there is told.
std::string command_there(const std::string& program, const std::string& folder,
                          const std::vector<std::string>& arguments);

}  // namespace limb_ring::ringctl
