#pragma once

#include <ros/time.h>

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace limb_ring::bridge {

/// The clock for stamps of what the bridge publishes: the machine's, on a virtual ring the ring's, and if that follows
/// an outer clock, the outer one. Any thread.
class RosClock {
 public:
  static constexpr std::int64_t kMachine = -1;

  /// The ring's time, ns since its start, or kMachine.
  void set_ring(std::int64_t now_ns) { ring_ns_ = now_ns; }
  /// What the outer clock shows at 0 of the ring's, ns; may be negative.
  void set_outer_zero(std::int64_t zero_ns) { outer_zero_ns_ = zero_ns; }

  ros::Time now() const {
    const std::int64_t ring_ns = ring_ns_;
    if (ring_ns != kMachine) return to_ros(ring_ns);
    const auto now = ros::WallTime::now();
    return {now.sec, now.nsec};
  }
  /// A stamp of the ring's as one for ROS, ns.
  std::int64_t outer(std::int64_t stamp_ns) const {
    return ring_ns_ == kMachine ? stamp_ns : std::max<std::int64_t>(0, stamp_ns + outer_zero_ns_);
  }
  /// As far as a time of ROS reaches: 0 to 2^32 s.
  ros::Time to_ros(std::int64_t stamp_ns) const {
    static const auto latest_ns = static_cast<std::int64_t>(ros::TIME_MAX.toNSec());
    ros::Time time;
    return time.fromNSec(static_cast<std::uint64_t>(std::clamp<std::int64_t>(outer(stamp_ns), 0, latest_ns)));
  }

 private:
  std::atomic<std::int64_t> ring_ns_{kMachine};
  std::atomic<std::int64_t> outer_zero_ns_{0};
};

}  // namespace limb_ring::bridge
