#pragma once

#include <limb_ring/RingStatus.h>
#include <visualization_msgs/Marker.h>

#include <map>
#include <string>
#include <vector>

#include "config/ring_config.h"

namespace limb_ring::bridge {

/// The limbs of nodes that are down or whose CPU hangs, as a shell in their colour around the robot's own: for each
/// joint of such a node the shape of the link that it moves, in that link's frame.
/// Namespace: limbs of NODE; id: joint, in the node's order.
class LimbMarks {
 public:
  /// `urdf`: the robot's description, or empty: no robot, no limbs.
  /// @throw std::invalid_argument where it is no URDF
  LimbMarks(const config::RingConfig& ring, const std::string& urdf);

  std::vector<visualization_msgs::Marker> markers(const RingStatus& status) const;
  /// The link that no joint moves; empty: no robot.
  const std::string& root() const { return root_; }

 private:
  const config::RingConfig& ring_;
  std::string root_;
  std::map<std::string, visualization_msgs::Marker> shapes_;  // by joint
};

}  // namespace limb_ring::bridge
