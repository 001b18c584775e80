#include <algorithm>

#include "app/common/from_roslaunch.h"
#include "app/ringctl/command/command_line.h"
#include "cli/output.h"
#include "process/standard_descriptors.h"

int main(int argc, char** argv) {
  limb_ring::process::open_standard_descriptors();
  limb_ring::process::outlive_file_limit();
  char** const end = std::remove_if(argv + 1, argv + argc, limb_ring::app::from_roslaunch);
  const int code = limb_ring::ringctl::run_command_line(static_cast<int>(end - argv), argv);
  return limb_ring::cli::code_with_output("ringctl", code);
}
