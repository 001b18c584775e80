#pragma once

#include "ros_bridge/kept_text.h"

namespace limb_ring::bridge {

/// The Bridge of this ROS node, by the node's own parameters, until ROS ends. Apart from Bridge, whose header takes
/// seconds to compile.
/// @param kept holds those parameters for the next life of this node: a ROS master that is new by then knows none
/// @throw as read_parameters()
void run_bridge(const KeptText& kept);

}  // namespace limb_ring::bridge
