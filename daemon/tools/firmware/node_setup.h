#pragma once

#include <string>

#include "tools/firmware/node_cpu.h"
#include "tools/firmware/options.h"

namespace limb_ring::firmware {

/// The node that the options choose, out of the ring's YAML. Without a YAML it has no joints and no
/// sensors.
struct ProgramSetup {
  std::string ring;  ///< empty: the only one running
  NodeSetup cpu;
  /// The daemon hears from this CPU at least so often: as the YAML says, where it does.
  std::chrono::milliseconds alive_period{200};
};

/// @throw config::ConfigError for a wrong YAML, OptionsError where it has no such node
ProgramSetup make_setup(const Options& options);

}  // namespace limb_ring::firmware
