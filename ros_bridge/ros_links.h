#pragma once

#include <chrono>
#include <map>
#include <string>

namespace limb_ring::bridge {

/// Checks the connections between this ROS node and nodes that hear one of its topics and answer on another. They must
/// be in place at both ends: what a node publishes before its own end is connected is lost. One thread.
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

/// Waits until no other node has a connection on which this one published a topic, which has ended: a rospy subscriber
/// that learns of a new publisher before it has noticed the end of the old one would never connect again. At most for
/// `patience`.
void await_unlinked(const std::string& topic, std::chrono::milliseconds patience);

}  // namespace limb_ring::bridge
