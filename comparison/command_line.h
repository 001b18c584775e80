#pragma once

namespace limb_ring::comparison {

/// Runs compare_networks. Errors go to standard error. @return 0 done; 1 gnuplot is missing or fails, or a disk is
/// full; 2 wrong arguments, or a folder that cannot be written
int run_command_line(int argc, char** argv);

}  // namespace limb_ring::comparison
