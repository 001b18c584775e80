#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <map>
#include <memory>

#include "ros_bridge/counters.h"
#include "ros_bridge/frame_filter.h"
#include "ros_bridge/ring_listener.h"
#include "ros_bridge/ros_clock.h"

namespace limb_ring::bridge {

/// `ring_frames`: packets on the nodes' lines. They are observed only while there is a subscriber; without
/// one this costs nothing. Counter `frames_watched_nodes`.
class FramesOut {
 public:
  FramesOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const ConnectOptions& daemon, FrameFilter filter,
            Counters& counters, const RosClock& clock);
  ~FramesOut();
  FramesOut(const FramesOut&) = delete;
  FramesOut& operator=(const FramesOut&) = delete;

 private:
  void on_subscribers();
  void take(const config::NodeConfig& node, const Message& message);
  void publish(const config::NodeConfig& node, const CapturedPacket& packet);

  const config::RingConfig& ring_;
  ConnectOptions daemon_;
  FrameFilter filter_;
  Counters& counters_;
  const RosClock& clock_;
  // Subscribers come and go in a thread of its own: the end of a listener waits for a daemon that does not answer, and
  // the other threads are the CPU's.
  ros::CallbackQueue queue_;
  ros::NodeHandle nodes_;
  ros::AsyncSpinner thread_;
  ros::Publisher publisher_;
  std::map<std::uint8_t, CaptureCounts> counts_;  // by node; of the listening thread
  std::unique_ptr<RingListener> listener_;        // last: its thread uses the others
};

}  // namespace limb_ring::bridge
