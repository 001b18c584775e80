#pragma once

#include <string>

#include "live/connect_node.h"

namespace limb_ring::ringctl {

using live::connect_node;
using live::Stay;

/// The error for a daemon that has gone while it was asked: names the node, and says why.
HostPortError gone(const HostPort& port, const std::string& reason);

}  // namespace limb_ring::ringctl
