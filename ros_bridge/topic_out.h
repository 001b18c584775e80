#pragma once

#include <ros/ros.h>

#include <map>

#include "config/ring_config.h"
#include "limb_ring/payload/reassembler.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/ring_port.h"

namespace limb_ring::bridge {

/// ROS topics of any type that come over the ring to this node, put together again and published
/// as they were, byte for byte. A topic is advertised when its type is announced.
class TopicOut {
 public:
  TopicOut(ros::NodeHandle& nodes, const config::RingConfig& ring, std::uint8_t own_id, RingPort& port,
           Counters& counters);

 private:
  struct Output {
    config::TopicConfig topic;
    payload::Announcement type;
    ros::Publisher publisher;
  };
  void on_packet(const Packet& packet);
  void on_announced(Output& output, const payload::Announcement& type);
  void on_message(Output& output, std::vector<std::uint8_t> bytes);
  void show_counters();

  ros::NodeHandle nodes_;
  RingPort& port_;
  Counters& counters_;
  payload::Reassembler reassembler_;
  std::map<std::uint8_t, Output> outputs_;  // by the topic's place in the configuration
};

}  // namespace limb_ring::bridge
