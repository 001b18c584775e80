#include <cstdlib>

#include "config/as_read.h"
#include "io/standard_descriptors.h"
#include "tools/cli/output.h"
#include "tools/ringctl/command/command_line.h"

int main(int argc, char** argv) {
  ::unsetenv(limb_ring::config::kAsRead);  // where a CPU calls it, too, it reads files as they are
  limb_ring::process::open_standard_descriptors();
  limb_ring::process::outlive_file_limit();
  const int code = limb_ring::ringctl::run_command_line(argc, argv);
  return limb_ring::cli::code_with_output("ringctl", code);
}
