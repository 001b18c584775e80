#pragma once

#include <limb_ring/ResetNode.h>
#include <limb_ring/SendInterrupt.h>
#include <limb_ring/Stop.h>
#include <ros/ros.h>

#include <optional>

#include "config/ring_config.h"
#include "ros_bridge/call_threads.h"
#include "ros_bridge/command_in.h"
#include "ros_bridge/fault_services.h"
#include "ros_bridge/resume_service.h"

namespace limb_ring::bridge {

/// `reset_node`, `send_interrupt`, `stop`, and those of ResumeService and FaultServices, each also under the bridge's
/// own name.
///
/// A call may take seconds, so calls have queues and threads of their own, and each opens a connection of its own to
/// the daemon, as any tool may: joint data does not wait for them. A stop waits for none of the others,
/// `send_interrupt` and `resume` for none of those that may take long. Every call ends by a deadline, `inject_fault` of
/// a freeze for a time when that is over; what went wrong is in its message.
class Services {
 public:
  /// `daemon` says how to reach the daemon of this bridge's node; its role is ignored.
  Services(const ros::NodeHandle& nodes, const config::RingConfig& ring, ConnectOptions daemon, RingPort& port,
           CommandIn& commands);
  ~Services();

 private:
  bool reset_node(ResetNode::Request& request, ResetNode::Response& response);
  bool send_interrupt(SendInterrupt::Request& request, SendInterrupt::Response& response);
  bool stop(Stop::Request& request, Stop::Response& response);

  const config::RingConfig& ring_;
  ConnectOptions daemon_;
  RingPort& port_;  ///< its time goes on during a call
  CallThreads stop_calls_, command_calls_, long_calls_;
  std::optional<ResumeService> resume_;
  std::optional<FaultServices> faults_;
};

}  // namespace limb_ring::bridge
