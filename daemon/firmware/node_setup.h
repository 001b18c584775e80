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
};

/// @throw config::ConfigError for a wrong YAML, OptionsError where it has no such node
ProgramSetup make_setup(const Options& options);

}  // namespace limb_ring::firmware
