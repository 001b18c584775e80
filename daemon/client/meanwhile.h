#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <utility>

namespace limb_ring::client {

/// What a program has to look at while the library waits (ConnectOptions::meanwhile).
class Meanwhile {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Meanwhile(std::function<void()> call) : call_(std::move(call)) {}

  /// How far a wait until `deadline` goes before the next look().
  Clock::time_point until(Clock::time_point deadline) const {
    return call_ ? std::min(deadline, Clock::now() + kPeriod) : deadline;
  }
  /// Calls it where the last time is long enough ago. What it throws ends the wait.
  void look() {
    if (!call_ || Clock::now() < due_) return;
    due_ = Clock::now() + kPeriod;
    call_();
  }

 private:
  static constexpr std::chrono::milliseconds kPeriod{50};

  std::function<void()> call_;
  Clock::time_point due_{};
};

}  // namespace limb_ring::client
