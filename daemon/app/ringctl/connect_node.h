#pragma once

#include <cstdint>
#include <string>

#include "limb_ring/host_port.h"

namespace limb_ring::ringctl {

/// Whether a command asks and goes, or needs its place for long: see ConnectOptions::asks_only.
enum class Stay : std::uint8_t { asks_only, for_long };

/// Connects to a node's daemon without waiting for one that is not there. @throw HostPortError
/// @param node id or name
HostPort connect_node(const std::string& ring, const std::string& node, Stay stay = Stay::asks_only);

/// The error for a daemon that has gone while it was asked: names the node, and says why.
HostPortError gone(const HostPort& port, const std::string& reason);

}  // namespace limb_ring::ringctl
