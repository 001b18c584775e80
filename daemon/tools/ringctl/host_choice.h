#pragma once

#include <string>

#include "config/ring_config.h"

namespace limb_ring::ringctl {

/// In the place of a host's name: all nodes on this machine, whatever hosts the file gives.
constexpr const char* kAllHosts = "all";

/// Which host's nodes are to be started here: the one given, else the only one whose address is this machine's.
/// @param given its name, kAllHosts, or empty
/// @return empty where the ring has no hosts
/// @throw UsageError where there is no such host, none of its nodes, or its address is not this machine's; and where
///        none is given and several or none could be meant
std::string chosen_host(const config::RingConfig& ring, const std::string& given);

/// @param host one of the ring's
bool has_nodes(const config::RingConfig& ring, const config::HostConfig& host);

/// "host 'head' has the address 10.0.0.2, which no interface of this machine has"
std::string not_here(const config::HostConfig& host);

}  // namespace limb_ring::ringctl
