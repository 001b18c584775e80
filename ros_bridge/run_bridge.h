#pragma once

namespace limb_ring::bridge {

/// The Bridge of this ROS node, by the node's own parameters, until ROS ends. Apart from Bridge, whose header takes
/// seconds to compile.
/// @throw as read_parameters()
void run_bridge();

}  // namespace limb_ring::bridge
