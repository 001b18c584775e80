#pragma once

#include "config/ring_config.h"
#include "link/input_line.h"
#include "link/output.h"

namespace limb_ring::runtime {

/// What one node's links are told, out of the configuration of its ring.
/// @param directory the ring's folder, where UNIX links live
link::InputSettings input_settings(const config::RingConfig& ring, const config::NodeConfig& node,
                                   const std::string& directory);
link::OutputSettings output_settings(const config::RingConfig& ring, const config::NodeConfig& node,
                                     const std::string& directory);

}  // namespace limb_ring::runtime
