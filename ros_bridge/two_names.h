#pragma once

#include <ros/ros.h>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace limb_ring::bridge {

/// What the ROS master knows, by full names: the nodes of each topic and service, including those that died without
/// telling it.
struct MasterState {
  using Nodes = std::set<std::string>;
  using ByName = std::map<std::string, Nodes>;
  ByName publishers, subscribers, services;

  /// None if nobody has it.
  static Nodes of(const ByName& all, const std::string& name) {
    const auto found = all.find(name);
    return found == all.end() ? Nodes{} : found->second;
  }
};

/// Nothing if the master does not answer. It does not wait for a master that is gone.
std::optional<MasterState> master_state();

/// The services of this node, each under two names: one below the node's own name (`ring_bridge/stop`), which is
/// unique, and the short one of its namespace (`stop`). If another living node offers the short name already, that node
/// keeps it: the master would otherwise take it away from that node without a message.
class TwoNames {
 public:
  /// @param nodes the node handle of the short names; calls come through its queue
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
