#pragma once

#include <ros/ros.h>

#include "config/ring_config.h"
#include "limb_ring/host_port.h"
#include "ros_bridge/frame_filter.h"

namespace limb_ring::bridge {

/// What ring_bridge was told in its private parameters (README.md lists them).
struct Parameters {
  config::RingConfig ring;
  ConnectOptions door;  ///< to the daemon of the bridge's node, as its CPU
  double rate = 50.0;   ///< Hz of joint_states
  XmlRpc::XmlRpcValue frames;  ///< what `ring_frames` shows, see FrameFilter
};

/// @throw std::invalid_argument, config::ConfigError naming what is wrong and what would be right
Parameters read_parameters(const ros::NodeHandle& own);

/// The node whose CPU a bridge is: the one named, else the only one with `cpu: attached`.
/// @throw std::invalid_argument naming the nodes that may have a bridge
const config::NodeConfig& bridge_node(const config::RingConfig& ring, const std::string& named);

}  // namespace limb_ring::bridge
