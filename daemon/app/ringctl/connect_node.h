#pragma once

#include <string>

#include "limb_ring/host_port.h"

namespace limb_ring::ringctl {

/// Connects to a node's daemon without waiting for one that is not there. @throw HostPortError
/// @param node id or name
HostPort connect_node(const std::string& ring, const std::string& node);

/// The error for a daemon that has gone while it was asked: names the node, and says why.
HostPortError gone(const HostPort& port, const std::string& reason);

}  // namespace limb_ring::ringctl
