#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "io/throttle.h"
#include "limb_ring/host_port.h"
#include "ros_bridge/ros_clock.h"
#include "ros_bridge/topic_in.h"

namespace limb_ring::bridge {

/// What each `/clock` means for a ring that follows it. Times in ns; no IO. (ours)
///
/// A `/clock` that is less than kJump earlier than the one before is noise, or late: the ring waits until `/clock` has
/// passed its latest value. If each step back were a jump, each step forward after it would give the ring the same time
/// again.
class OuterTime {
 public:
  static constexpr std::int64_t kJump = 1'000'000'000;

  struct Step {
    std::int64_t former_ns;   ///< of `/clock`, as allowed before
    std::int64_t time_ns;     ///< of `/clock`
    std::int64_t zero_ns;     ///< what `/clock` shows at 0 of the ring's
    std::int64_t reached_ns;  ///< of the ring's time, as allowed before
    bool begins, jumped_back;
    std::int64_t until_ns() const { return time_ns - zero_ns; }
  };

  /// Nothing if the ring's time is to stay as it is.
  std::optional<Step> next(std::int64_t time_ns) const;
  /// To be called when the daemon has allowed `step`.
  void allowed(const Step& step);
  bool has_begun() const { return zero_ns_.has_value(); }
  /// For a ring that had been allowed this much time before; 0: the ring begins anew.
  void take_over(std::int64_t zero_ns, std::int64_t allowed_ns);

 private:
  std::optional<std::int64_t> zero_ns_;  ///< of `/clock`, where the ring's is 0
  std::int64_t last_ns_ = 0;             ///< of `/clock`, as passed on
};

/// Chooses the publisher whose `/clock` is followed: the first that is heard, until it has been silent for kSilent. Two
/// publishers at once would be a clock that jumps back and forth.
class ClockPublisher {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kSilent{2};

  bool is(const std::string& node, Clock::time_point now = Clock::now());
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  Clock::time_point heard_{};
};

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
  using Event = ros::MessageEvent<rosgraph_msgs::Clock const>;
  void on_clock(const Event& event);
  void run();
  /// Waits for a `/clock` that has not been passed on yet, in ns; nothing when this object is being destroyed.
  std::optional<std::int64_t> await_time();
  void pass_on_or_keep(HostPort& port, std::int64_t time_ns);
  void pass_on(HostPort& port, std::int64_t time_ns);
  /// Takes over the zero and the allowed time that a previous bridge has set.
  void take_over(HostPort& port);

  ConnectOptions daemon_;
  RosClock& clock_;
  OuterTime outer_;
  process::Throttle jumps_{std::chrono::seconds(1)}, behind_{std::chrono::seconds(1)},
      others_{std::chrono::seconds(10)};
  ClockPublisher publisher_;
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
