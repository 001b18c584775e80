#pragma once

#include <optional>

#include "config/ring_config.h"
#include "link/input_line.h"
#include "link/output.h"

namespace limb_ring::setup {

/// What one node's links are told, out of the configuration of its ring.
struct LinkSettings {
  struct Ends {
    link::InputSettings input;
    link::OutputSettings output;
  };
  Ends first;
  std::optional<Ends> second;  ///< where the ring folds back
};
/// @param directory the ring's folder, where UNIX links live
LinkSettings link_settings(const config::RingConfig& ring, const config::NodeConfig& node,
                           const std::string& directory);

}  // namespace limb_ring::setup
