#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace limb_ring::ringctl {

/// A node held by a daemon that lives, as its lock file says.
struct HeldNode {
  std::string lock;  ///< path of the lock file
  pid_t pid = -1;    ///< of the daemon; -1 where the file does not tell
};

/// Nodes of a ring's folder that are held right now. No daemon: an empty list.
std::vector<HeldNode> held_nodes(const std::string& folder);

/// Removes what daemons that are gone have left in a ring's folder, and the folder.
/// Call only where nothing is held any more.
void remove_leftovers(const std::string& folder);

}  // namespace limb_ring::ringctl
