#include "ros_bridge/run_bridge.h"

#include "ros_bridge/bridge.h"

namespace limb_ring::bridge {

void run_bridge() {
  const Bridge bridge(ros::NodeHandle(), read_parameters(ros::NodeHandle("~")));
  ros::spin();
}

}  // namespace limb_ring::bridge
