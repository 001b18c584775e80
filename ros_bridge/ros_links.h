#pragma once

#include <ros/ros.h>

#include <chrono>
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

/// Checks the connections between this ROS node and nodes that subscribe to one of its topics and answer on another.
/// Both ends must be connected: what a node publishes before its own end is connected is lost. One thread.
class RosLinks {
 public:
  /// @param heard, answered topics, resolved names
  /// @return true if somebody publishes `answered`, and each such node is connected to this one and hears `heard`. A
  /// node that has not subscribed to `heard` within a second need not hear it. Takes up to half a second per node.
  bool answers_arrive(const std::string& heard, const std::string& answered);

 private:
  bool is_patient_with(const std::string& node);

  std::map<std::string, std::chrono::steady_clock::time_point> seen_;  ///< by node: since when without a subscription
};

/// Waits, at most for `patience`, until no other node still has a connection to a topic that this node no longer
/// publishes. A rospy subscriber that learns of a new publisher before it has noticed the end of the old one would
/// never connect again.
void await_unlinked(const std::string& topic, std::chrono::milliseconds patience);

}  // namespace limb_ring::bridge
