#include <cstdlib>

#include "config/entry.h"
#include "io/spawn.h"
#include "tools/common/command_line.h"
#include "tools/ringctl/command_line.h"

int main(int argc, char** argv) {
  ::unsetenv(limb_ring::config::kAsRead);  // where a CPU calls it, too, it reads files as they are
  limb_ring::process::open_standard_descriptors();
  limb_ring::process::outlive_file_limit();
  const int code = limb_ring::ringctl::run_command_line(argc, argv);
  return limb_ring::cli::code_with_output("ringctl", code);
}
