#pragma once

#include <chrono>
#include <map>
#include <string>

namespace limb_ring::bridge {

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
