#include "comparison/command_line.h"
#include "io/spawn.h"
#include "tools/common/command_line.h"

int main(int argc, char** argv) {
  limb_ring::process::open_standard_descriptors();
  limb_ring::process::outlive_file_limit();
  limb_ring::cli::end_interrupted_with_one("compare_networks");
  return limb_ring::cli::code_with_output("compare_networks", limb_ring::comparison::run_command_line(argc, argv));
}
