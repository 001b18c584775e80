#pragma once

#include <chrono>
#include <map>
#include <string>

namespace limb_ring::bridge {

/// Whether the connections between this ROS node and those that hear a topic of it and answer on another are in place
/// at both ends: what a node publishes before its end is, is lost. One thread.
class RosLinks {
 public:
  /// @param heard, answered topics, resolved names
  /// @return true where somebody publishes `answered`, everybody who does has his connection to this node, and hears
  /// `heard`, unless he has not subscribed to it within a second. It takes up to half a second for each of them.
  bool answers_arrive(const std::string& heard, const std::string& answered);

 private:
  bool is_patient_with(const std::string& node);

  std::map<std::string, std::chrono::steady_clock::time_point> seen_;  ///< by node: since when without a subscription
};

}  // namespace limb_ring::bridge
