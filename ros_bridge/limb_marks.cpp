#include "ros_bridge/limb_marks.h"

#include <urdf_parser/urdf_parser.h>

#include <stdexcept>

#include "ros_bridge/node_colour.h"
#include "ros_bridge/ring_picture.h"

namespace limb_ring::bridge {
namespace {

using visualization_msgs::Marker;

constexpr double kShell = 0.008;  // m, thickness around the robot's own shape
constexpr float kAlpha = 0.75f;

void box(Marker& marker, double x, double y, double z) {
  marker.scale.x = x + 2 * kShell;
  marker.scale.y = y + 2 * kShell;
  marker.scale.z = z + 2 * kShell;
}

/// @return false for a mesh: what it measures is not known here
bool take_shape(const urdf::Geometry& geometry, Marker& marker) {
  if (geometry.type == urdf::Geometry::SPHERE) {
    const double width = 2 * static_cast<const urdf::Sphere&>(geometry).radius;
    marker.type = Marker::SPHERE;
    box(marker, width, width, width);
  } else if (geometry.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
    marker.type = Marker::CYLINDER;
    box(marker, 2 * cylinder.radius, 2 * cylinder.radius, cylinder.length);
  } else if (geometry.type == urdf::Geometry::BOX) {
    const auto& size = static_cast<const urdf::Box&>(geometry).dim;
    marker.type = Marker::CUBE;
    box(marker, size.x, size.y, size.z);
  } else {
    return false;
  }
  return true;
}

Marker shape_of(const urdf::Link& link) {
  constexpr double kUnknown = 0.06;  // m, a ball where the shape cannot be had
  Marker marker = blank_marker(link.name, "", 0, Marker::SPHERE);
  marker.frame_locked = true;
  if (!link.visual || !link.visual->geometry || !take_shape(*link.visual->geometry, marker))
    box(marker, kUnknown, kUnknown, kUnknown);
  if (!link.visual) return marker;
  const urdf::Pose& pose = link.visual->origin;
  marker.pose.position.x = pose.position.x;
  marker.pose.position.y = pose.position.y;
  marker.pose.position.z = pose.position.z;
  pose.rotation.getQuaternion(marker.pose.orientation.x, marker.pose.orientation.y, marker.pose.orientation.z,
                              marker.pose.orientation.w);
  return marker;
}

}  // namespace

LimbMarks::LimbMarks(const config::RingConfig& ring, const std::string& urdf) : ring_(ring) {
  if (urdf.empty()) return;
  const auto model = urdf::parseURDF(urdf);
  if (!model) throw std::invalid_argument("parameter robot_description is no URDF");
  root_ = model->getRoot()->name;
  for (const auto& [name, joint] : model->joints_) shapes_[name] = shape_of(*model->getLink(joint->child_link_name));
}

std::vector<Marker> LimbMarks::markers(const RingStatus& status) const {
  std::vector<Marker> all;
  for (const auto& node : ring_.nodes) {
    const Condition condition = condition_of(node, status);
    // A node in an open chain still works: its ball on the ring shows the chain, its limb is not marked.
    if (condition != Condition::hung && condition != Condition::down) continue;
    for (std::size_t joint = 0; joint < node.joints.size(); ++joint) {
      const auto shape = shapes_.find(node.joints[joint].name);
      if (shape == shapes_.end()) continue;
      Marker marker = shape->second;
      marker.ns = "limbs of " + node.name;
      marker.id = static_cast<int>(joint);
      marker.color = colour_of(condition, kAlpha);
      all.push_back(marker);
    }
  }
  return all;
}

}  // namespace limb_ring::bridge
