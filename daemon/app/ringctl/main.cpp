#include "app/ringctl/command/command_line.h"

int main(int argc, char** argv) { return limb_ring::ringctl::run_command_line(argc, argv); }
