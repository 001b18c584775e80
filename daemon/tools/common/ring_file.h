#pragma once

#include <string>

namespace limb_ring::app {

/// The ring's YAML file that a command is given: a path, or a ring's name, whose file is NAME.yaml in the user's
/// configuration ($XDG_CONFIG_HOME/limb_ring, ~/.config/limb_ring), in /etc/limb_ring, or among those that came with
/// limb_ring; the first that is there.
/// @return its path; `given` where it holds a '/' or a '.', or is a file
/// @throw config::ConfigError naming the folders, where there is none
std::string ring_file(const std::string& given);

}  // namespace limb_ring::app
