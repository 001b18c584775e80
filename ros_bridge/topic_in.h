#pragma once

#include <ros/ros.h>
#include <topic_tools/shape_shifter.h>

#include <deque>
#include <mutex>
#include <string>

#include "ros_bridge/direct_queue.h"
#include "ros_bridge/publisher_check.h"
#include "ros_bridge/throttle.h"
#include "ros_bridge/topic_sender.h"

namespace limb_ring::bridge {

/// A ROS topic of any type, subscribed here and sent to the node the configuration names. Its type may change:
/// the publisher may be replaced by one of another type or definition, which would refuse a subscription of roscpp's
/// alone.
class TopicIn {
 public:
  TopicIn(ros::NodeHandle& nodes, std::uint8_t number, const config::TopicConfig& topic, RingPort& port,
          Counters& counters);

  /// Any thread: the CPU of the node this topic goes to has restarted.
  void far_side_restarted();
  const config::TopicConfig& topic() const { return topic_; }
  /// The input's, as the master has it.
  const std::string& full_name() const { return full_name_; }
  /// One thread: the master should be asked how many nodes publish it. (PublisherLook)
  bool wants_look() { return check_.wants_look(subscriber_.getNumPublishers()); }
  /// The same thread: so many, as far as the master knows.
  void look(unsigned published);

 private:
  using Event = ros::MessageEvent<topic_tools::ShapeShifter const>;
  void on_message(const Event& event);
  void take_type(const payload::Announcement& type);
  void renew();
  void warn_too_large(std::size_t bytes);
  void hand_over();

  config::TopicConfig topic_;
  RingPort& port_;
  Counters& counters_;
  TopicSender sender_;  // as the next, ring thread only
  Throttle too_large_{std::chrono::seconds(10)};
  std::mutex mutex_;
  std::deque<TopicMessage> handed_in_;  // at most topic_.queue
  PublisherCheck check_;
  std::string datatype_, md5sum_;  ///< of the last message
  ros::NodeHandle nodes_;
  std::string full_name_;
  DirectQueue at_once_;
  ros::SubscribeOptions options_;
  ros::Subscriber subscriber_;  ///< after the constructor look()'s thread alone; last: its callback uses the others
};

}  // namespace limb_ring::bridge
