#pragma once

#include <limb_ring/Frame.h>

#include "config/ring_config.h"
#include "limb_ring/captured_packet.h"

namespace limb_ring::bridge {

/// What was seen by the daemon of `node`, as a message; what was left out is not filled in. A node that
/// is not configured goes by its id. Fields that the packet did not come to are 0.
Frame to_frame(const CapturedPacket& packet, const config::NodeConfig& node, const config::RingConfig& ring);

}  // namespace limb_ring::bridge
