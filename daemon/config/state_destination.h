#pragma once

#include <cstdint>

#include "config/ring_config.h"

namespace limb_ring::config {

/// Where limbs send their states and readings, and their commands come from (ours): the first node
/// in ring order whose CPU is attached (the bridge, usually the body's), else the first node.
/// @pre the ring has a node
std::uint8_t state_destination(const RingConfig& ring);

}  // namespace limb_ring::config
