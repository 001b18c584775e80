#pragma once

#include <limb_ring/ClearFaults.h>
#include <limb_ring/InjectFault.h>
#include <limb_ring/ListFaults.h>
#include <limb_ring/ResetNode.h>
#include <limb_ring/Resume.h>
#include <limb_ring/SendInterrupt.h>
#include <limb_ring/Stop.h>
#include <ros/callback_queue.h>
#include <ros/duration.h>
#include <ros/ros.h>

#include <chrono>
#include <cstdint>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "ring/known_stops.h"
#include "ring/live_faults.h"
#include "ring/ring_client.h"
#include "ros_bridge/command_in.h"
#include "ros_bridge/ring_port.h"
#include "ros_bridge/ros_links.h"

namespace limb_ring::bridge {

/// Services whose calls are served by threads of their own. (ours)
class CallThreads {
 public:
  /// @param nodes of their short names
  /// @param threads how many calls are served at a time; the others wait
  CallThreads(const ros::NodeHandle& nodes, unsigned threads)
      : nodes_(nodes), threads_(threads, &queue_), names_(on_own_queue()) {}

  /// Where services are advertised. @pre not yet started
  TwoNames& names() { return names_; }
  void start() { threads_.start(); }
  /// Returns when the calls under way have ended; there are no further ones.
  void stop() {
    names_.shutdown();
    threads_.stop();
  }

 private:
  const ros::NodeHandle& on_own_queue() {
    nodes_.setCallbackQueue(&queue_);
    return nodes_;
  }

  ros::CallbackQueue queue_;
  ros::NodeHandle nodes_;
  ros::AsyncSpinner threads_;
  TwoNames names_;
};

/// `inject_fault`, `clear_faults`, `list_faults`: what `ringctl fault` does, for all nodes of the ring whose daemons
/// run on this host. A call returns when it has taken effect, or by a deadline. If something went wrong, its message
/// says what.
class FaultServices {
 public:
  /// @param own the bridge's node
  FaultServices(TwoNames& names, const config::RingConfig& ring, const std::string& own, RingPort& port);

 private:
  bool inject(InjectFault::Request& request, InjectFault::Response& response);
  bool clear(ClearFaults::Request& request, ClearFaults::Response& response);
  bool list(ListFaults::Request& request, ListFaults::Response& response);
  void require_survival(const fault::Fault& fault) const;

  fault::RingNodes ring_nodes_;
  std::string own_;
  RingPort& port_;  ///< its time goes on during a call
  live::LiveFaults faults_;
};

/// `resume`: ends the stop that is latched at one node or at all nodes. The bridge sends it as it sends commands. If it
/// cannot reach a node, another node of this host sends it.
class ResumeService {
 public:
  /// @param daemon the bridge's, as a tool connects to it
  ResumeService(TwoNames& names, const config::RingConfig& ring, ConnectOptions daemon, RingPort& port,
                CommandIn& commands);

 private:
  bool resume(Resume::Request& request, Resume::Response& response);
  /// Of these, the ones with joints, and those on this host that say that a stop is latched.
  std::vector<ask::Resumed> nodes_to_resume(std::uint8_t destination) const;
  std::future<Result> resume_from_bridge(std::uint8_t node);
  /// @throw HostPortError
  Result resume_from(std::uint8_t sender, std::uint8_t node, std::chrono::milliseconds timeout) const;

  const config::RingConfig& ring_;
  ConnectOptions daemon_;
  RingPort& port_;  ///< its time goes on during a call
  CommandIn& commands_;
};

/// `reset_node`, `send_interrupt`, `stop`, and those of ResumeService and FaultServices, each also under the bridge's
/// own name.
///
/// A call may take seconds, so calls have their own queues and threads, and each opens its own connection to the
/// daemon, as any tool may: joint data does not wait for them. A stop does not wait for any other call;
/// `send_interrupt` and `resume` do not wait for calls that may take long. Every call ends by a deadline;
/// `inject_fault` with a freeze for a time ends when that time is over. If something went wrong, its message says what.
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

/// @name What callers of services write. @throw std::invalid_argument saying what is allowed
///@{

constexpr std::chrono::seconds kServiceAnswer{10};  ///< a send ends after timeouts.queue and its tries

/// The time-out of a call; 0: the default. Very short ones are refused: rosservice reads a whole number as nanoseconds,
/// which nobody means here.
std::chrono::milliseconds timeout_of(const ros::Duration& asked, std::chrono::seconds usual = kServiceAnswer);

/// Id of a node by id or name.
std::uint8_t one_node(const config::RingConfig& ring, const std::string& node);
/// The same, or kBroadcast for "all".
std::uint8_t destination_of(const config::RingConfig& ring, const std::string& node);
/// The one of that id or name; all for "all" and if none is named.
std::vector<ask::Node> nodes_to_ask(const config::RingConfig& ring, const std::string& which = "");

///@}

}  // namespace limb_ring::bridge
