#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace limb_ring::process {

/// Limits how many lines go to a log in each period, and counts those that are held back. Used in ROS, too: roscpp's
/// own throttled warnings stay silent under use_sim_time while /clock does. (ours)
class Throttle {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Throttle(Clock::duration period, std::uint64_t most = 1) : period_(period), most_(most) {}
  /// @return how many were held back since one was let through; nothing: this one is, too
  std::optional<std::uint64_t> allow(Clock::time_point now = Clock::now()) {
    if (now >= next_) {
      next_ = now + period_;
      let_through_ = 0;
    }
    if (let_through_ == most_) {
      ++held_back_;
      return std::nullopt;
    }
    ++let_through_;
    return std::exchange(held_back_, 0);
  }

 private:
  Clock::duration period_;
  std::uint64_t most_;  ///< per period
  Clock::time_point next_{};
  std::uint64_t let_through_ = 0;  ///< in this period
  std::uint64_t held_back_ = 0;
};

/// "; 41 more since the last such line": the end of a line that was let through; "" if nothing was held back.
inline std::string and_more(std::uint64_t held_back) {
  return held_back == 0 ? "" : "; " + std::to_string(held_back) + " more since the last such line";
}

}  // namespace limb_ring::process
