#include "app/ring_sim/command_line.h"

int main(int argc, char** argv) { return limb_ring::ring_sim::run_command_line(argc, argv); }
