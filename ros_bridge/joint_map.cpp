#include "ros_bridge/joint_map.h"

namespace limb_ring::bridge {

JointMap::JointMap(const config::RingConfig& ring) {
  for (const auto& follower : ring.followers) leaders_[follower.name] = follower.leader;
  for (std::size_t node = 0; node < ring.nodes.size(); ++node) {
    const auto& joints = ring.nodes[node].joints;
    ids_.push_back(ring.nodes[node].id);
    counts_.push_back(joints.size());
    for (std::size_t joint = 0; joint < joints.size(); ++joint) {
      places_[joints[joint].name] = {node, joint};
      names_ += (names_.empty() ? "" : ", ") + joints[joint].name;
    }
  }
}

std::string JointMap::leader_of(const std::string& joint) const {
  const auto found = leaders_.find(joint);
  return found == leaders_.end() ? std::string() : found->second;
}

std::optional<JointMap::Place> JointMap::find(const std::string& joint) const {
  const auto found = places_.find(joint);
  if (found == places_.end()) return std::nullopt;
  return found->second;
}

}  // namespace limb_ring::bridge
