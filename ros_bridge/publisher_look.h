#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <memory>
#include <vector>

#include "ros_bridge/topic_in.h"

namespace limb_ring::bridge {

/// Tells each TopicIn once a second how many publish its topic. In a thread of its own, since a master that is out of
/// reach does not answer for minutes, and the other threads are the CPU's.
class PublisherLook {
 public:
  /// @param topics outlive this
  PublisherLook(const ros::NodeHandle& nodes, const std::vector<std::unique_ptr<TopicIn>>& topics);
  ~PublisherLook();

 private:
  void look();

  const std::vector<std::unique_ptr<TopicIn>>& topics_;
  ros::CallbackQueue queue_;
  ros::NodeHandle nodes_;
  ros::AsyncSpinner thread_;
  ros::WallTimer timer_;
};

}  // namespace limb_ring::bridge
