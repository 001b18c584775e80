#pragma once

#include <limb_ring/RingStatus.h>
#include <std_msgs/ColorRGBA.h>
#include <visualization_msgs/Marker.h>
#include <visualization_msgs/MarkerArray.h>

#include <map>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "ros_bridge/health.h"

namespace limb_ring::bridge {

/// The frame of the picture: x towards the viewer, y to the right, z up; m, the ring's centre at 0.
constexpr const char* kRingFrame = "ring";

/// The ring as markers: a ball for each node, clockwise from the top, in the colour of its condition, with its
/// name and median round trip; an arrow for each line, blue (idle) to yellow (full), red where it is broken, with
/// a cross there; an arrow past every bypassed node.
/// Namespaces: nodes, names (id: the node's), lines, breaks, bypasses (id: of the node they lead from).
class RingPicture {
 public:
  explicit RingPicture(const config::RingConfig& ring) : ring_(ring) {}

  std::vector<visualization_msgs::Marker> markers(const RingStatus& status, const LineLoad& load) const;

 private:
  using Marker = visualization_msgs::Marker;
  geometry_msgs::Point place(std::size_t index, double radius) const;
  Marker node_marker(std::size_t index, const RingStatus& status) const;
  Marker name_marker(std::size_t index, const NodeStatus* node) const;
  Marker arrow(const char* ns, std::size_t from, std::size_t to) const;
  Marker cross(std::size_t from) const;
  void add_line(std::size_t index, const RingStatus& status, const LineLoad& load, std::vector<Marker>& to) const;

  const config::RingConfig& ring_;
};

/// A marker that stays until the next picture, and goes by the newest transform.
visualization_msgs::Marker blank_marker(const std::string& frame, const std::string& ns, int id, int type);

/// The limbs of nodes that are down or whose CPU hangs, as a coloured shell around the robot's own limb: for each joint
/// of such a node the shape of the link that it moves, in that link's frame.
/// Namespace: limbs of NODE; id: joint, in the node's order.
class LimbMarks {
 public:
  /// `urdf`: the robot's description, or empty: no robot, no limbs.
  /// @throw std::invalid_argument if it is not a URDF
  LimbMarks(const config::RingConfig& ring, const std::string& urdf);

  std::vector<visualization_msgs::Marker> markers(const RingStatus& status) const;
  /// The link that no joint moves; empty: no robot.
  const std::string& root() const { return root_; }

 private:
  const config::RingConfig& ring_;
  std::string root_;
  std::map<std::string, visualization_msgs::Marker> shapes_;  // by joint
};

/// The condition of a node, each shown in a colour of its own.
enum class Condition {
  well,     ///< up, and its CPU runs
  unclear,  ///< joining, in an open chain, folded, its CPU boots or is not there
  hung,     ///< its network controller relays, its CPU does not answer
  down      ///< not heard, alone, or with a duplicate id
};

Condition condition_of(const config::NodeConfig& node, const RingStatus& ring);
std_msgs::ColorRGBA colour_of(Condition condition, float alpha = 1);
std_msgs::ColorRGBA colour(float red, float green, float blue, float alpha = 1);

}  // namespace limb_ring::bridge
