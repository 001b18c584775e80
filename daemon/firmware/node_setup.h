#pragma once

#include <string>

#include "firmware/node_cpu.h"
#include "firmware/options.h"

namespace limb_ring::firmware {

/// What the options lead to: the node's part of the ring's YAML. Without a YAML a node without
/// joints and sensors.
struct ProgramSetup {
  std::string ring;  ///< empty: the only one running
  NodeSetup cpu;
  /// The promise to the daemon: something is heard of this CPU at least so often. The YAML's, where
  /// it gives one.
  std::chrono::milliseconds alive_period{200};
};

/// @throw config::ConfigError for a wrong YAML, OptionsError where it has no such node
ProgramSetup make_setup(const Options& options);

}  // namespace limb_ring::firmware
