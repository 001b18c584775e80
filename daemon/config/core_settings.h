#pragma once

#include <string>

#include "config/ring_config.h"
#include "core/settings.h"

namespace limb_ring::setup {

/// The settings of one node's core, from its ring's configuration; the same in the daemon and under a virtual clock.
core::Settings core_settings(const config::RingConfig& ring, const config::NodeConfig& node, std::uint64_t boot);

/// DATPs of 524 bytes that the node's insertion buffer needs room for so that an intact ring loses none: one of each
/// node if the line into it or out of it has a data rate, else 2. (ours, protocol.md section 2.5)
unsigned insertion_buffer_needed(const config::RingConfig& ring, const config::NodeConfig& node);
/// "limits.insertion_buffer is 8, ..."; empty if it is not given, or is as large as that.
std::string too_small_insertion_buffer(const config::RingConfig& ring, const config::NodeConfig& node);

/// The ids of all nodes, in ring order.
core::RingOrder order_of(const config::RingConfig& ring);
/// The node's place in ring order, from 0. @pre it is one of the ring's
std::size_t index_of(const config::RingConfig& ring, const config::NodeConfig& node);
/// How long one byte takes on that line; 0 if the line has no data rate.
core::Duration byte_time(const config::LinkConfig& link);

}  // namespace limb_ring::setup
