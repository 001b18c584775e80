#pragma once

#include <limb_ring/Frame.h>

#include "config/ring_config.h"
#include "limb_ring/captured_packet.h"

namespace limb_ring::bridge {

/// A packet that the daemon of `node` has captured, as a message; what was left out is not filled in. A node that
/// is not configured is named by its id. Fields beyond the end of a cut-off packet are 0.
Frame to_frame(const CapturedPacket& packet, const config::NodeConfig& node, const config::RingConfig& ring);

}  // namespace limb_ring::bridge
