#pragma once

#include <limb_ring/RingStatus.h>
#include <ros/ros.h>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "ros_bridge/counters.h"
#include "ros_bridge/events_out.h"
#include "ros_bridge/joint_data_out.h"
#include "ros_bridge/ring_watch.h"

namespace limb_ring::bridge {

/// `ring_status`, latched: once a second, and at once when a node or CPU changes its state, a
/// joint falls silent, a stop is latched or ended, or the daemon goes; and `stopped`, latched, on change. A thread of
/// its own asks the daemons.
class StatusOut {
 public:
  /// The CPU of a node (by id) has restarted.
  using OnBoot = std::function<void(std::uint8_t node)>;

  using OnStatus = std::function<void(const RingStatus&)>;

  StatusOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const ConnectOptions& daemon, RingPort& port,
            const JointDataOut& joints, const EventsOut& events, const Counters& counters, OnBoot on_boot);
  ~StatusOut();
  /// Before start(): calls `handler` with every status that is published, from this class's thread.
  void on_status(OnStatus handler) { on_status_.push_back(std::move(handler)); }
  void start();

 private:
  /// What is published at once when it changes.
  struct Noticed {
    std::string digest;               ///< of the daemons' states
    std::vector<std::string> silent;  ///< joints
    std::vector<std::string> silent_sensors;
    std::string problem;               ///< of the bridge's own connection
    std::vector<std::string> stopped;  ///< nodes whose joint states say that a stop is latched

    bool operator!=(const Noticed& other) const {
      return std::tie(digest, silent, silent_sensors, problem, stopped) !=
             std::tie(other.digest, other.silent, other.silent_sensors, other.problem, other.stopped);
    }
  };

  void run();
  bool is_due();
  void publish();
  void fill_header(RingStatus& status);
  void fill_joints(NodeStatus& node) const;
  std::string problem();
  std::vector<std::string> stopped_nodes() const;
  void tell_stopped(const RingStatus& status);

  const config::RingConfig& ring_;
  std::string own_node_;
  const RosClock& clock_;
  RingWatch watch_;
  const JointDataOut& joints_;
  const EventsOut& events_;
  const Counters& counters_;
  OnBoot on_boot_;
  std::vector<OnStatus> on_status_;
  ros::Publisher publisher_, stopped_;

  Noticed noticed_;  ///< last
  std::chrono::steady_clock::time_point published_{};
  std::optional<bool> told_stopped_;

  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::string problem_ = "not connected yet";
  std::thread thread_;
};

}  // namespace limb_ring::bridge
