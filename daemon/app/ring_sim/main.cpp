#include "app/ring_sim/command_line.h"
#include "cli/output.h"
#include "process/standard_descriptors.h"

int main(int argc, char** argv) {
  limb_ring::process::open_standard_descriptors();
  limb_ring::process::outlive_file_limit();
  return limb_ring::cli::code_with_output("ring_sim", limb_ring::ring_sim::run_command_line(argc, argv));
}
