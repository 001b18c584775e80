#pragma once

#include <chrono>
#include <functional>
#include <memory>

#include "io/node_clock.h"

namespace limb_ring::runtime {

/// Whether the CPU on the host port speaks. One that has promised a word every alive period is silent after three of
/// them without one, until it speaks again.
class SilenceWatch {
 public:
  using Time = event_loop::NodeClock::Time;
  using milliseconds = std::chrono::milliseconds;

  /// @param on_silent called when it falls silent
  SilenceWatch(event_loop::NodeClock& clock, std::function<void()> on_silent);

  /// A CPU has come, which counts as a word. @param alive_period promised by it; 0: no promise, so it is never silent
  void begin(milliseconds alive_period);
  /// From now on it does not fall silent any more.
  void end() { timer_->cancel(); }
  /// @return whether that has ended a silence
  bool spoke(Time now);

  bool silent() const { return silent_; }
  milliseconds silent_for() const { return std::chrono::duration_cast<milliseconds>(clock_.now() - spoke_); }
  milliseconds alive_period() const { return alive_period_; }

 private:
  Time silent_at() const;
  void watch();
  void watch_until(Time when);
  void time_over();

  event_loop::NodeClock& clock_;
  std::function<void()> on_silent_;
  std::unique_ptr<event_loop::Timer> timer_;
  Time over_at_{};  ///< when timer_ runs out
  milliseconds alive_period_{0};
  Time spoke_{};
  bool silent_ = false;
};

}  // namespace limb_ring::runtime
