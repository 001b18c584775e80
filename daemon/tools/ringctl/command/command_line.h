#pragma once

namespace limb_ring::ringctl {

/// Runs ringctl. Errors go to standard error. @return an ExitCode
int run_command_line(int argc, char** argv);

}  // namespace limb_ring::ringctl
