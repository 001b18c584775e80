#pragma once

#include <XmlRpcValue.h>
#include <limb_ring/Frame.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "limb_ring/captured_packet.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/ring_listener.h"
#include "ros_bridge/ros_clock.h"

namespace limb_ring::bridge {

/// Which frames are published: the private parameters below `frames`, all of which may be left out.
///
///   nodes        names or ids, or `all`: whose lines are observed; default: the bridge's own node, whose
///                input every packet of a closed ring passes once
///   at           in, out; default in
///   kinds        data, control, interrupt; default all
///   source       names or ids; default all
///   destination  names or ids, `all`: broadcasts; default all
///   priority, channel   numbers, of data packets; default all
///   sample       n: every n-th of those, from 1; default 1
///   limit        at most so many a second from each node, 0: no limit; default 1000
///
/// A list of one may be given without brackets.
struct FrameFilter {
  std::vector<const config::NodeConfig*> nodes;
  std::string order;  ///< as HostPort::observe() takes it
};

/// @throw std::invalid_argument naming parameter, value and what would be right
FrameFilter read_frame_filter(XmlRpc::XmlRpcValue parameters, const config::RingConfig& ring,
                              const config::NodeConfig& own);

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

/// A packet that the daemon of `node` has captured, as a message; what was left out is not filled in. A node that
/// is not configured is named by its id. Fields beyond the end of a cut-off packet are 0.
Frame to_frame(const CapturedPacket& packet, const config::NodeConfig& node, const config::RingConfig& ring);

/// Names of frames for tf: with the parameter `tf_prefix` in front, if it is set in this node's namespace or above, as
/// in robot_state_publisher. So two robots with the same URDF have frames of their own.
class FrameNames {
 public:
  /// Asks the parameter server.
  FrameNames();
  std::string of(const std::string& frame) const { return prefix_.empty() ? frame : prefix_ + '/' + frame; }

 private:
  std::string prefix_;
};

}  // namespace limb_ring::bridge
