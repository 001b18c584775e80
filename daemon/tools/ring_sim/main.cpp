#include <unistd.h>

#include <csignal>

#include "io/spawn.h"
#include "tools/common/command_line.h"
#include "tools/ring_sim/command_line.h"

namespace {

constexpr char kInterrupted[] = "ring_sim: interrupted\n";

/// With 1, as --help says. soak and explore hold these signals back, to print what they have.
void end_interrupted(int) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kInterrupted, sizeof kInterrupted - 1);
  ::_exit(limb_ring::ring_sim::kBroken);
}

}  // namespace

int main(int argc, char** argv) {
  limb_ring::process::open_standard_descriptors();
  limb_ring::process::outlive_file_limit();
  for (const int number : {SIGINT, SIGTERM, SIGHUP})  // one that is ignored, as by nohup, stays so
    if (std::signal(number, end_interrupted) == SIG_IGN) std::signal(number, SIG_IGN);
  return limb_ring::cli::code_with_output("ring_sim", limb_ring::ring_sim::run_command_line(argc, argv));
}
