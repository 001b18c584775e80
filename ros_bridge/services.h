#pragma once

#include <limb_ring/ResetNode.h>
#include <limb_ring/Resume.h>
#include <limb_ring/SendInterrupt.h>
#include <limb_ring/Stop.h>
#include <ros/ros.h>

#include <future>
#include <optional>
#include <string>

#include "ask/resumed.h"
#include "ask/status_rows.h"
#include "config/ring_config.h"
#include "ros_bridge/call_threads.h"
#include "ros_bridge/command_in.h"
#include "ros_bridge/fault_services.h"

namespace limb_ring::bridge {

/// `reset_node`, `send_interrupt`, `stop`, `resume`, and those of FaultServices, each also under the bridge's own name.
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
  bool resume(Resume::Request& request, Resume::Response& response);
  std::future<Result> ask_to_resume(std::uint8_t node);

  /// Id of a node by id or name, kBroadcast for "all".
  /// @throw std::invalid_argument naming the nodes there are
  std::uint8_t destination(const std::string& node) const;
  std::uint8_t one_node(const std::string& node) const;
  /// All, or the one of that id or name.
  std::vector<ask::Node> nodes_to_ask(const std::string& which = "") const;
  /// Of these, the ones with joints, and those on this host that say that a stop is latched.
  std::vector<ask::Resumed> nodes_to_resume(std::uint8_t destination) const;
  /// From another node than the bridge's. @throw HostPortError
  Result resume_from(std::uint8_t sender, std::uint8_t node, std::chrono::milliseconds timeout) const;

  const config::RingConfig& ring_;
  ConnectOptions daemon_;
  RingPort& port_;  ///< its time goes on during a call
  CommandIn& commands_;
  CallThreads stop_calls_, command_calls_, long_calls_;
  std::optional<FaultServices> faults_;
};

}  // namespace limb_ring::bridge
