#pragma once

#include <functional>

namespace limb_ring::bridge {

/// Runs `program` in a child process, and again whenever that ends, since a reset of its node kills a bridge.
/// roslaunch's own respawn would also restart, for ever, a bridge with wrong parameters.
///
/// Ends where this process is asked to (SIGINT, SIGTERM, SIGHUP: passed on to the child), where the child ends with 2:
/// with wrong parameters another try would end the same way, and with its child where whoever started it is gone: of a
/// roslaunch that was killed nobody else would end it.
/// @pre this process has one thread
/// @return exit code of the last child
int respawned(const std::function<int()>& program);

}  // namespace limb_ring::bridge
