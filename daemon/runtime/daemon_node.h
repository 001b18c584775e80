#pragma once

#include "runtime/node.h"

namespace limb_ring::runtime {

/// A node that is a process of its own, with links to its neighbours. To be asked for before the process pins itself to
/// its cores: its CPU and the daemon that takes its place get those that it has now.
NodeBase daemon_base(boost::asio::io_context& io, const config::RingConfig& ring, const config::NodeConfig& node);

}  // namespace limb_ring::runtime
