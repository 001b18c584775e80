#pragma once

#include "node/node.h"

namespace limb_ring::runtime {

/// A node that is a process of its own, with links to its neighbours. Call this before the process pins itself to its
/// cores: its CPU, and the daemon that re_exec() starts in its place, get the cores that the process has now.
NodeBase daemon_base(boost::asio::io_context& io, const config::RingConfig& ring, const config::NodeConfig& node);

}  // namespace limb_ring::runtime
