#pragma once

#include "config/ring_config.h"
#include "core/settings.h"

namespace limb_ring::setup {

/// What one node's core is told, out of the configuration of its ring: in the daemon and under a
/// virtual clock alike.
core::Settings core_settings(const config::RingConfig& ring, const config::NodeConfig& node, std::uint64_t boot);

/// Ids in ring order.
core::RingOrder order_of(const config::RingConfig& ring);
/// The node's place in ring order, from 0. @pre it is one of the ring's
std::size_t index_of(const config::RingConfig& ring, const config::NodeConfig& node);
/// Of one byte on that line; 0 where it is as fast as the host.
core::Duration byte_time(const config::LinkConfig& link);

}  // namespace limb_ring::setup
