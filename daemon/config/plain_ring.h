#pragma once

#include <string>

#include "config/config_error.h"
#include "config/ring_config.h"

namespace limb_ring::config {

/// A ring without a file: ids 0 to nodes-1, names node0 and so on, no CPUs, all else default.
/// @throw ConfigError where the name is no ring name or `nodes` is not 2 to 255.
RingConfig plain_ring(const std::string& ring, unsigned nodes);

/// Makes every link of the ring `unix`, `shm` or `udp`, whatever its file says (the command line's transport).
/// @throw ConfigError for any other word, or where a line would come from beyond its host without a key
void apply_transport(RingConfig& ring, const std::string& transport);

/// All nodes are on this machine, whatever hosts the file gives: a robot's ring tried out at a desk.
void apply_one_host(RingConfig& ring);

/// Gives the ring another name (a second ring of one file on a host). UDP ports that came from the
/// old name move to the new one's.
/// @throw ConfigError where it is no ring name.
void rename_ring(RingConfig& ring, const std::string& name);

/// Where a ring's UDP ports begin unless its file says otherwise: id 0 has this one, id n the
/// n-th after it. Of the ring's name, so that rings side by side on a host do not meet; 17000 to
/// 32104 in steps of 256, below the ports Linux gives out by itself. (ours)
std::uint16_t default_first_port(const std::string& ring);

}  // namespace limb_ring::config
