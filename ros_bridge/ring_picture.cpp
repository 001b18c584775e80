#include "ros_bridge/ring_picture.h"

#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace limb_ring::bridge {
namespace {

using visualization_msgs::Marker;

constexpr double kRadius = 0.85;      // m, around a robot of 1.1 m
constexpr double kNameRadius = 1.19;  // of the radius
constexpr double kBall = 0.07, kText = 0.042, kShaft = 0.012, kHead = 0.035, kCross = 0.05, kStroke = 0.015;
const double kTurn = 2 * std::acos(-1.0);

const NodeStatus* find(const RingStatus& ring, std::uint8_t id) {
  const auto found =
      std::find_if(ring.nodes.begin(), ring.nodes.end(), [id](const auto& node) { return node.id == id; });
  return found == ring.nodes.end() ? nullptr : &*found;
}

void scale(Marker& marker, double x, double y, double z) {
  marker.scale.x = x;
  marker.scale.y = y;
  marker.scale.z = z;
}

geometry_msgs::Point between(const geometry_msgs::Point& a, const geometry_msgs::Point& b, double share) {
  geometry_msgs::Point point;
  point.x = a.x + share * (b.x - a.x);
  point.y = a.y + share * (b.y - a.y);
  point.z = a.z + share * (b.z - a.z);
  return point;
}

bool is_said_broken(const RingStatus& status, std::uint8_t from, std::uint8_t to) {
  return std::any_of(status.nodes.begin(), status.nodes.end(),
                     [&](const auto& node) { return node.broken_before == from && node.broken_behind == to; });
}

std_msgs::ColorRGBA load_colour(const std::optional<double>& load) {
  if (!load) return colour(0.5f, 0.5f, 0.5f);
  const auto share = static_cast<float>(*load);
  return colour(0.15f + 0.85f * share, 0.45f + 0.4f * share, 0.95f - 0.85f * share);
}

std::string round_trip_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "\n%.0f us", seconds * 1e6);
  return seconds > 0 ? text : "";
}

}  // namespace

Marker blank_marker(const std::string& frame, const std::string& ns, int id, int type) {
  Marker marker;
  marker.header.frame_id = frame;
  marker.ns = ns;
  marker.id = id;
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1;
  return marker;
}

geometry_msgs::Point RingPicture::place(std::size_t index, double radius) const {
  const double angle = kTurn * static_cast<double>(index) / static_cast<double>(ring_.nodes.size());
  geometry_msgs::Point point;
  point.y = radius * std::sin(angle);
  point.z = radius * std::cos(angle);
  return point;
}

Marker RingPicture::node_marker(std::size_t index, const RingStatus& status) const {
  const auto& node = ring_.nodes[index];
  Marker ball = blank_marker(kRingFrame, "nodes", node.id, Marker::SPHERE);
  ball.pose.position = place(index, kRadius);
  scale(ball, kBall, kBall, kBall);
  ball.color = colour_of(condition_of(node, status));
  return ball;
}

Marker RingPicture::name_marker(std::size_t index, const NodeStatus* node) const {
  const auto& config = ring_.nodes[index];
  Marker text = blank_marker(kRingFrame, "names", config.id, Marker::TEXT_VIEW_FACING);
  text.pose.position = place(index, kNameRadius * kRadius);
  text.scale.z = kText;
  text.color = colour(1, 1, 1);
  text.text = config.name;
  if (node && node->stopped) text.text += "\nstopped";
  if (node) text.text += node->state == "up" ? round_trip_text(node->round_trip_p50) : "\n" + node->state;
  return text;
}

Marker RingPicture::arrow(const char* ns, std::size_t from, std::size_t to) const {
  Marker arrow = blank_marker(kRingFrame, ns, ring_.nodes[from].id, Marker::ARROW);
  const auto begin = place(from, kRadius), end = place(to, kRadius);
  const double length = std::hypot(end.y - begin.y, end.z - begin.z);
  const double gap = length > 0 ? std::min(0.4, kBall / 2 / length) : 0;  // clear of the balls
  arrow.points = {between(begin, end, gap), between(begin, end, 1 - gap)};
  scale(arrow, kShaft, kHead, kHead);
  return arrow;
}

Marker RingPicture::cross(std::size_t from) const {
  Marker cross = blank_marker(kRingFrame, "breaks", ring_.nodes[from].id, Marker::LINE_LIST);
  const auto middle = between(place(from, kRadius), place((from + 1) % ring_.nodes.size(), kRadius), 0.5);
  for (const auto& [y, z] : {std::pair{-1, -1}, {1, 1}, {-1, 1}, {1, -1}}) {
    auto point = middle;
    point.y += kCross * y;
    point.z += kCross * z;
    cross.points.push_back(point);
  }
  cross.scale.x = kStroke;
  cross.color = colour_of(Condition::down);
  return cross;
}

void RingPicture::add_line(std::size_t index, const RingStatus& status, const LineLoad& load,
                           std::vector<Marker>& to) const {
  const std::size_t next = (index + 1) % ring_.nodes.size();
  const std::uint8_t from_id = ring_.nodes[index].id, to_id = ring_.nodes[next].id;
  const NodeStatus* from = find(status, from_id);
  Marker line = arrow("lines", index, next);
  const NodeStatus* behind = find(status, to_id);
  // Of a node without a daemon here, as a foreign one, the node behind it knows.
  const bool is_told_behind = from && from->pid == 0 && behind && behind->input_from == from_id;
  const bool leads_on = is_told_behind || (from && from->output_to == to_id);
  line.color = leads_on ? load_colour(load.of(to_id)) : colour(0.5f, 0.5f, 0.5f, 0.4f);
  if (is_said_broken(status, from_id, to_id)) {
    line.color = colour_of(Condition::down);
    to.push_back(cross(index));
  }
  to.push_back(line);
  if (!from || leads_on || from->output_to < 0) return;
  const auto far = std::find_if(ring_.nodes.begin(), ring_.nodes.end(),
                                [&](const auto& node) { return node.id == from->output_to; });
  if (far == ring_.nodes.end()) return;
  Marker bypass = arrow("bypasses", index, static_cast<std::size_t>(far - ring_.nodes.begin()));
  bypass.color = load_colour(load.of(far->id));
  to.push_back(bypass);
}

std::vector<Marker> RingPicture::markers(const RingStatus& status, const LineLoad& load) const {
  std::vector<Marker> all;
  for (std::size_t i = 0; i < ring_.nodes.size(); ++i) {
    all.push_back(node_marker(i, status));
    all.push_back(name_marker(i, find(status, ring_.nodes[i].id)));
    add_line(i, status, load, all);
  }
  return all;
}

namespace {

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
  if (!model) throw std::invalid_argument("parameter robot_description is not a URDF");
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
