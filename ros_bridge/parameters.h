#pragma once

#include <ros/ros.h>

#include "config/ring_config.h"
#include "limb_ring/host_port.h"
#include "ros_bridge/frames_out.h"

namespace limb_ring::bridge {

/// What ring_bridge was told in its private parameters (launch/bridge.launch lists them).
struct Parameters {
  config::RingConfig ring;
  /// To the daemon of the bridge's node, as its CPU. If no node has an attached CPU, as a tool: then there
  /// are status, events and services, but no joint data and no topics.
  ConnectOptions daemon;
  double rate = 50.0;          ///< Hz of joint_states
  bool promises = false;       ///< judges the ring's promises, for /diagnostics
  bool tells_time = false;     ///< publishes /clock if the ring is virtual
  bool follows = false;        ///< lets a virtual ring's time go on as far as /clock has come
  std::string sample_log;      ///< path of a file that says which samples each joint_states holds; empty: none
  XmlRpc::XmlRpcValue frames;  ///< what `ring_frames` shows, see FrameFilter
};

/// Reads them, and warns of parameters that nobody reads.
/// @throw std::invalid_argument, config::ConfigError naming what is wrong and what would be right
Parameters read_parameters(const ros::NodeHandle& own);

/// A private parameter by its name, as getParam() gives it (not valid: it is not given).
/// @return its value; the default, or an empty text, if it is not given
/// @throw std::invalid_argument if it is of another type. getParam(name, value) would treat it as not given, or round
/// it.
std::string text_parameter(const std::string& name, XmlRpc::XmlRpcValue given);
double number_parameter(const std::string& name, XmlRpc::XmlRpcValue given, double usual);
/// Hz of joint_states; if 0 or nothing is given, as configured.
double rate_parameter(XmlRpc::XmlRpcValue given, double configured);
bool flag_parameter(const std::string& name, XmlRpc::XmlRpcValue given, bool usual);

/// A value as one writes it: `fast`, `true`, `[1, 2]`, `{at: in}`.
std::string as_written(XmlRpc::XmlRpcValue value);

/// Those of the private parameters, a map, that nobody reads, such as a misspelt one.
std::vector<std::string> unknown_parameters(XmlRpc::XmlRpcValue own);

/// The value of a private parameter in the parameter server.
XmlRpc::XmlRpcValue given_parameter(const ros::NodeHandle& own, const std::string& name);

/// Parameter ~config: path of the ring's YAML file. @throw std::invalid_argument if it is not given
std::string config_parameter(const ros::NodeHandle& own);

/// The node that a bridge belongs to: the one named, which must have an attached CPU, else config::body_of().
/// @throw std::invalid_argument naming the nodes that may have a bridge
const config::NodeConfig& bridge_node(const config::RingConfig& ring, const std::string& named);

}  // namespace limb_ring::bridge
