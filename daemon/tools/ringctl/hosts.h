#pragma once

#include <string>
#include <vector>

#include "config/ring_config.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {

/// A launch file for `ring.launch machines:=`: a machine tag for each host that has nodes, and host.launch for it.
/// @param env_loader script on each host that sets up ROS and runs its arguments
/// @param user whom to log in as, if a host's `ssh` does not say; empty: roslaunch's own choice
/// @throw std::invalid_argument if the ring has no hosts
std::string machines_file(const config::RingConfig& ring, const std::string& env_loader, const std::string& user);

/// A script that runs a program in an environment like this process's, if the hosts are set up alike: env.sh of the
/// first catkin workspace or installation in `prefix_path`, else /usr/bin/env.
/// @param prefix_path folders separated by ':' (CMAKE_PREFIX_PATH)
std::string usual_env_loader(const std::string& prefix_path);

/// Runs the same command line on the host that can do it, by ssh without prompts (BatchMode). It runs in the folder of
/// the same name, if there is one, with the ringctl of the same path, else the one on PATH. Its output and exit code
/// become ours; kNoRing if ssh cannot reach the host.
/// @param arguments without the program's name and without --ssh
/// @return an ExitCode, only if ssh cannot be started
int run_there(const Elsewhere& where, const std::vector<std::string>& arguments);

/// What is asked of the ringctl there: these, and the ring's name if they do not say it.
std::vector<std::string> arguments_there(const std::string& ring, std::vector<std::string> arguments);

/// What the shell there is told.
std::string command_there(const std::string& program, const std::string& folder,
                          const std::vector<std::string>& arguments);

/// Instead of a host's name: all nodes on this machine, whatever hosts the file gives.
constexpr const char* kAllHosts = "all";

/// Which host's nodes are to be started here: the one given, else the only one whose address is this machine's.
/// @param given its name, kAllHosts, or empty
/// @return empty if the ring has no hosts
/// @throw UsageError if there is no such host, none of its nodes, or its address is not this machine's; and where
///        none is given and several or none could be meant
std::string chosen_host(const config::RingConfig& ring, const std::string& given);

/// @param host one of the ring's
bool has_nodes(const config::RingConfig& ring, const config::HostConfig& host);

/// "host 'head' has the address 10.0.0.2, which no interface of this machine has"
std::string not_here(const config::HostConfig& host);

}  // namespace limb_ring::ringctl
