#pragma once

#include <vector>

#include "config/ring_config.h"
#include "core/line.h"
#include "io/input_line.h"
#include "io/output.h"

namespace limb_ring::setup {

/// What the links of one line are told at one node.
struct LinkSettings {
  core::Line line;
  link::InputSettings input;
  link::OutputSettings output;
};
/// For each line of the ring, out of its configuration.
/// @param directory the ring's folder, where UNIX links live
std::vector<LinkSettings> link_settings(const config::RingConfig& ring, const config::NodeConfig& node,
                                        const std::string& directory);

}  // namespace limb_ring::setup
