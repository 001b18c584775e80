#include "app/common/out_file.h"
#include "app/ring_sim/command_line.h"

int main(int argc, char** argv) {
  return limb_ring::app::code_with_output("ring_sim", limb_ring::ring_sim::run_command_line(argc, argv));
}
