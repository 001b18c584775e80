#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <thread>

#include "limb_ring/host_port.h"
#include "ros_bridge/ros_clock.h"

namespace limb_ring::bridge {

/// Lets the time of a virtual ring (`ringctl up --clock follow`) go on as far as `/clock`, which somebody else
/// publishes (Gazebo, rosbag play --clock). The first `/clock` that is heard is 0 of the ring's clock. While `/clock`
/// stands, so does the ring. If it jumps back, the ring goes on from where it is, and its stamps follow `/clock`.
class ClockFollower {
 public:
  /// @param daemon says how to reach the daemon of the bridge's node; its role is ignored @param clock outlives this
  ClockFollower(const ros::NodeHandle& nodes, ConnectOptions daemon, RosClock& clock);
  ~ClockFollower();
  ClockFollower(const ClockFollower&) = delete;
  ClockFollower& operator=(const ClockFollower&) = delete;

 private:
  void on_clock(const rosgraph_msgs::Clock& message);
  void run();
  /// Waits for a `/clock` that has not been passed on yet, in ns; nothing when this object is being destroyed.
  std::optional<std::int64_t> await_time();
  void pass_on_or_keep(HostPort& port, std::int64_t time_ns);
  void pass_on(HostPort& port, std::int64_t time_ns);
  /// Takes over the zero and the allowed time that a previous bridge has set.
  void take_over(HostPort& port);

  ConnectOptions daemon_;
  RosClock& clock_;
  std::optional<std::int64_t> zero_ns_;  ///< of `/clock`, where the ring's is 0
  std::int64_t last_ns_ = 0;             ///< of `/clock`, as passed on
  std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<std::int64_t> newest_ns_;
  std::atomic<bool> stopping_{false};
  ros::CallbackQueue queue_;
  ros::NodeHandle nodes_;
  ros::AsyncSpinner spinner_;
  ros::Subscriber subscriber_;
  std::thread thread_;
};

}  // namespace limb_ring::bridge
