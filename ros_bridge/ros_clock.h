#pragma once

#include <ros/time.h>

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace limb_ring::bridge {

/// Nanoseconds since 1970 as a ROS time, limited to its range: 0 to 2^32 s, in the year 2106.
inline ros::Time to_ros_time(std::int64_t stamp_ns) {
  static const auto latest_ns = static_cast<std::int64_t>(ros::TIME_MAX.toNSec());
  ros::Time time;
  return time.fromNSec(static_cast<std::uint64_t>(std::clamp<std::int64_t>(stamp_ns, 0, latest_ns)));
}

/// The clock for the stamps of what the bridge publishes: the machine's clock; on a virtual ring, the ring's clock; if
/// that ring follows an outer clock, the outer clock. Any thread.
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
  /// A stamp of the ring's, ns, as one for ROS.
  ros::Time to_ros(std::int64_t stamp_ns) const {
    const ros::Time stamp = to_ros_time(stamp_ns);
    if (ring_ns_ == kMachine) return stamp;
    return to_ros_time(static_cast<std::int64_t>(stamp.toNSec()) + outer_zero_ns_);
  }

 private:
  std::atomic<std::int64_t> ring_ns_{kMachine};
  std::atomic<std::int64_t> outer_zero_ns_{0};
};

}  // namespace limb_ring::bridge
