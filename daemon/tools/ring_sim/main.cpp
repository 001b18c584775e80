#include "io/spawn.h"
#include "tools/common/command_line.h"
#include "tools/ring_sim/command_line.h"

int main(int argc, char** argv) {
  limb_ring::process::open_standard_descriptors();
  limb_ring::process::outlive_file_limit();
  limb_ring::cli::end_interrupted_with_one("ring_sim");  // soak and explore hold these signals back
  return limb_ring::cli::code_with_output("ring_sim", limb_ring::ring_sim::run_command_line(argc, argv));
}
