#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <memory>
#include <vector>

#include "ros_bridge/topic_in.h"

namespace limb_ring::bridge {

/// Asks the master how many publish the topics of each TopicIn: once a second where one wants to know, else every ten
/// seconds, since the master has more to do than to answer this. In a thread of its own, since a master that is out of
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
  ros::SteadyTimer timer_;
  unsigned passed_over_ = 0;  ///< turns in which nobody was asked
};

}  // namespace limb_ring::bridge
