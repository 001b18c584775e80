// ring_bridge: the CPU of one node of the ring, for ROS.
#include <ros/ros.h>

#include <exception>

#include "ros_bridge/bridge.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "ring_bridge");
  try {
    const limb_ring::bridge::Bridge bridge(
        ros::NodeHandle(), limb_ring::bridge::read_parameters(ros::NodeHandle("~")));
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
