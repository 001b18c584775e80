#pragma once

namespace limb_ring::bridge {

/// The Bridge of this ROS node, by the node's own parameters, until ROS ends. Apart from Bridge, whose header takes
/// seconds to compile.
/// @throw std::runtime_error a parameter or the ring's configuration is wrong: which one, and what would be right
void run_bridge();

}  // namespace limb_ring::bridge
