// ring_bridge: the CPU of one node of the ring, for ROS.
#include <cstring>

#include "io/spawn.h"
#include "ros_bridge/node_main.h"

namespace {

constexpr const char* kHelp =
    "ring_bridge: the CPU of one node of a ring, as a ROS node. Usually started by bridge.launch:\n"
    "  roslaunch --ros-args limb_ring bridge.launch\n"
    "Usage: ring_bridge [--respawn] _PARAMETER:=VALUE ...\n"
    "  --respawn  restart it whenever it ends, except after wrong parameters: a reset of its node kills it\n"
    "Parameters: ~config, ~ring, ~node, ~rate, ~frames, ~clock, ~promises, ~sample_log: as the arguments of\n"
    "  bridge.launch;\n"
    "  ~respawn: true if --respawn or roslaunch restarts it; else the answer to a reset of its node warns that\n"
    "  nobody restarts it\n";

/// Takes the flag out of the arguments.
bool take_flag(int& argc, char** argv, const char* flag) {
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], flag) != 0) continue;
    for (int next = i; next < argc; ++next) argv[next] = argv[next + 1];  // and the null behind the last
    --argc;
    return true;
  }
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  limb_ring::process::open_standard_descriptors();  // also of the one that starts it again
  limb_ring::process::outlive_file_limit();
  const bool respawn = take_flag(argc, argv, "--respawn");
  const limb_ring::bridge::KeptText parameters;
  const auto node = [&] {
    return limb_ring::bridge::run_node(argc, argv,
                                       {"ring_bridge", kHelp, [&] { limb_ring::bridge::run_bridge(parameters); }});
  };
  return respawn ? limb_ring::bridge::respawned(node) : node();
}
