#pragma once

#include <limb_ring/RingStatus.h>
#include <visualization_msgs/MarkerArray.h>

#include <string>

#include "config/ring_config.h"
#include "ros_bridge/line_load.h"

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

}  // namespace limb_ring::bridge
