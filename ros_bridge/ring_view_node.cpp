// ring_view: what RViz shows of a ring, from ring_status and joint_states alone (live, or out of a bag).
#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <visualization_msgs/MarkerArray.h>

#include "config/load_ring.h"
#include "ros_bridge/frames_out.h"
#include "ros_bridge/gait.h"
#include "ros_bridge/node_main.h"
#include "ros_bridge/parameters.h"
#include "ros_bridge/ring_picture.h"

namespace limb_ring::bridge {
namespace {

const ros::WallDuration kFrame{1.0 / 30};  // of what is seen, not of what is controlled

constexpr const char* kHelp =
    "ring_view: markers of a ring and its robot for RViz. Usually started by view.launch.\n"
    "Parameters: ~config: YAML file of the ring; robot_description: URDF of the robot, may be missing\n";

/// By /clock where that is told, as RViz and tf go by it; else by the machine's clock.
ros::Time now_for_tf() {
  if (ros::Time::isSimTime() && !ros::Time::now().isZero()) return ros::Time::now();
  const auto now = ros::WallTime::now();
  return {now.sec, now.nsec};
}

class RingView {
 public:
  RingView(ros::NodeHandle& nodes, const config::RingConfig& ring)
      : picture_(ring),
        limbs_(ring, nodes.param("robot_description", std::string())),
        joints_(ring),
        markers_(nodes.advertise<visualization_msgs::MarkerArray>("ring_markers", 1, /*latch=*/true)),
        held_(nodes.advertise<sensor_msgs::JointState>("held_joint_states", 1)) {
    if (!limbs_.root().empty()) place_robot();
    const auto at_once = ros::TransportHints().tcpNoDelay();  // else roscpp waits to fill a TCP segment
    status_in_ = nodes.subscribe("ring_status", 1, &RingView::show, this, at_once);
    states_in_ = nodes.subscribe("joint_states", 1, &RingView::take_joints, this, at_once);
    timer_ = nodes.createSteadyTimer(
        kFrame, [this](const ros::SteadyTimerEvent&) { held_.publish(joints_.all(now_for_tf())); });
  }

 private:
  void place_robot() {
    geometry_msgs::TransformStamped robot;
    robot.header.stamp = now_for_tf();
    robot.header.frame_id = frames_.of(kRingFrame);
    robot.child_frame_id = frames_.of(limbs_.root());
    robot.transform.rotation.w = 1;
    transforms_.sendTransform(robot);
  }

  void take_joints(const sensor_msgs::JointState& message) { joints_.take(message); }

  void show(const RingStatus& status) {
    load_.take(status);
    visualization_msgs::MarkerArray all;
    all.markers = picture_.markers(status, load_);
    for (auto& limb : limbs_.markers(status)) all.markers.push_back(std::move(limb));
    // What is not in this picture any more (a break, a limb) leaves the screen.
    auto clear = blank_marker(kRingFrame, "", 0, visualization_msgs::Marker::ARROW);
    clear.action = visualization_msgs::Marker::DELETEALL;
    all.markers.insert(all.markers.begin(), clear);
    for (auto& marker : all.markers) marker.header.frame_id = frames_.of(marker.header.frame_id);
    markers_.publish(all);
  }

  const FrameNames frames_;
  RingPicture picture_;
  LimbMarks limbs_;
  HeldJoints joints_;
  LineLoad load_;
  tf2_ros::StaticTransformBroadcaster transforms_;
  ros::Publisher markers_, held_;
  ros::Subscriber status_in_, states_in_;
  ros::SteadyTimer timer_;
};

void run() {
  ros::NodeHandle nodes;
  const auto ring = config::load_ring(config_parameter(ros::NodeHandle("~")));
  const RingView view(nodes, ring);
  ros::spin();
}

}  // namespace
}  // namespace limb_ring::bridge

int main(int argc, char** argv) {
  using namespace limb_ring::bridge;
  return run_node(argc, argv, {"ring_view", kHelp, run});
}
