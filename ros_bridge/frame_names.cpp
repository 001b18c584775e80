#include "ros_bridge/frame_names.h"

#include <ros/ros.h>

namespace limb_ring::bridge {

FrameNames::FrameNames() {
  const ros::NodeHandle own("~");
  std::string parameter;
  if (own.searchParam("tf_prefix", parameter)) own.getParam(parameter, prefix_);
  if (!prefix_.empty() && prefix_.front() == '/') prefix_.erase(0, 1);
}

}  // namespace limb_ring::bridge
