#pragma once

#include <ros/ros.h>

#include <string>
#include <vector>

#include "ros_bridge/master_state.h"

namespace limb_ring::bridge {

/// The services of this node, each under two names: the node's own (`ring_bridge/stop`), which nobody else has, and the
/// short one of its namespace (`stop`). If another living node offers the short name already, it keeps it: the master
/// would otherwise take it away from that node without a message.
class TwoNames {
 public:
  /// @param nodes of the short names; calls come by its queue
  explicit TwoNames(const ros::NodeHandle& nodes);

  template <typename Owner, typename Request, typename Response>
  void advertise(const std::string& name, bool (Owner::*call)(Request&, Response&), Owner* owner) {
    servers_.push_back(own_.advertiseService(name, call, owner));
    if (!belongs_to_another(name)) servers_.push_back(short_.advertiseService(name, call, owner));
  }
  /// No further calls.
  void shutdown();

 private:
  bool belongs_to_another(const std::string& name);

  ros::NodeHandle short_, own_;
  MasterState::ByName providers_;  ///< of services that the master knew of at the start
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace limb_ring::bridge
