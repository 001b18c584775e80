#pragma once

namespace limb_ring::ring_sim {

/// Runs ring_sim. Errors go to standard error. @return an ExitCode
int run_command_line(int argc, char** argv);

}  // namespace limb_ring::ring_sim
