#pragma once

#include <cstdint>

#include "config/ring_config.h"

namespace limb_ring::firmware {

/// Where limbs send their states and readings (ours): the first node in ring order whose CPU is
/// attached (the bridge, usually the body's), else the first node.
/// @pre the ring has a node
std::uint8_t state_destination(const config::RingConfig& ring);

}  // namespace limb_ring::firmware
