#pragma once

#include <ros/ros.h>

#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "config/ring_config.h"
#include "limb_ring/payload/reassembler.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/ring_port.h"
#include "ros_bridge/work_thread.h"

namespace limb_ring::bridge {

/// ROS topics of any type that come over the ring to this node, put together again and published
/// as they were, byte for byte. A topic is advertised when its type is announced, in a thread of its own: where the
/// master is gone, that waits until it is back. Meanwhile its messages wait, at most as many as its queue holds.
class TopicOut {
 public:
  TopicOut(ros::NodeHandle& nodes, const config::RingConfig& ring, std::uint8_t own_id, RingPort& port,
           Counters& counters);

 private:
  struct Output {
    config::TopicConfig topic;
    std::optional<payload::Announcement> type;  ///< announced last
    ros::Publisher publisher;                   ///< of that type; none until it is advertised
    bool is_advertising = false;                ///< of that type or of an earlier one
    std::deque<std::vector<std::uint8_t>> waiting;
  };
  struct Advertised {
    Output* output;
    ros::Publisher publisher;
    payload::Announcement type;
  };
  void on_packet(const Packet& packet);
  void on_announced(Output& output, const payload::Announcement& type);
  void on_message(Output& output, std::vector<std::uint8_t> bytes);
  void publish(Output& output, std::vector<std::uint8_t> bytes);
  /// The oldest of those that wait.
  void drop(Output& output, std::size_t oldest);
  /// @param before its publisher of another type, which ends
  void advertise(Output& output, ros::Publisher before);
  void take_advertised();
  void each_second();

  ros::NodeHandle nodes_;
  RingPort& port_;
  Counters& counters_;
  payload::Reassembler reassembler_;
  std::map<std::uint8_t, Output> outputs_;  // by the topic's place in the configuration
  std::mutex mutex_;
  std::vector<Advertised> advertised_;  ///< and not yet taken by the ring thread
  WorkThread advertiser_;               // last: it uses the others
};

}  // namespace limb_ring::bridge
