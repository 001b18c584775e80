#include "ros_bridge/node_colour.h"

#include <algorithm>

namespace limb_ring::bridge {

Condition condition_of(const config::NodeConfig& node, const RingStatus& ring) {
  const auto status =
      std::find_if(ring.nodes.begin(), ring.nodes.end(), [&](const auto& other) { return other.id == node.id; });
  if (status == ring.nodes.end() || status->state == "down" || status->state == "alone" ||
      status->state == "duplicate_id")
    return Condition::down;
  const bool silent = std::any_of(node.joints.begin(), node.joints.end(), [&](const auto& joint) {
    return std::count(ring.silent_joints.begin(), ring.silent_joints.end(), joint.name) != 0;
  });
  const std::string& cpu = status->cpu_state;
  if (cpu == "silent" || cpu == "hung" || cpu == "failed") return Condition::hung;
  if (status->state != "up" || cpu == "absent" || cpu == "booting") return Condition::unclear;
  // A CPU that has promised no alive_period shows by its joints alone.
  return silent ? Condition::hung : Condition::well;
}

std_msgs::ColorRGBA colour(float red, float green, float blue, float alpha) {
  std_msgs::ColorRGBA made;
  made.r = red;
  made.g = green;
  made.b = blue;
  made.a = alpha;
  return made;
}

std_msgs::ColorRGBA colour_of(Condition condition, float alpha) {
  switch (condition) {
    case Condition::well:
      return colour(0.2f, 0.8f, 0.3f, alpha);
    case Condition::unclear:
      return colour(1.0f, 0.8f, 0.1f, alpha);
    case Condition::hung:
      return colour(1.0f, 0.45f, 0.0f, alpha);
    case Condition::down:
      break;
  }
  return colour(0.95f, 0.1f, 0.1f, alpha);
}

}  // namespace limb_ring::bridge
