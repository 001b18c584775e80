#pragma once

#include <string>

#include "config/ring_config.h"

namespace limb_ring::ringctl {

/// A launch file for `ring.launch machines:=`: a machine tag for each host that has nodes, and host.launch for it.
/// @param env_loader script on each host that sets up ROS and runs its arguments
/// @param user whom to log in as, where a host's `ssh` does not say; empty: roslaunch's own choice
/// @throw std::invalid_argument where the ring has no hosts
std::string machines_file(const config::RingConfig& ring, const std::string& env_loader, const std::string& user);

/// A script that runs a program in an environment like this process's, if the hosts are set up alike: env.sh of the
/// first catkin workspace or installation in `prefix_path`, else /usr/bin/env.
/// @param prefix_path folders separated by ':' (CMAKE_PREFIX_PATH)
std::string usual_env_loader(const std::string& prefix_path);

}  // namespace limb_ring::ringctl
