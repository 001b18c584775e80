#pragma once

#include "io/endpoint.h"

namespace limb_ring::link {

/// Judges at every tick whether the other end has fallen silent. (ours, protocol.md section 6.10)
/// A late tick counts as two at most: an end that was not scheduled itself knows nothing about the other.
class Silence {
 public:
  explicit Silence(const Timing& timing) : timing_(timing) {}

  void restart(Time now);
  /// Something came. Cheap: called for every read.
  void heard() { heard_ = true; }
  /// Call at every tick. @return true: nothing came for `timing.silence`.
  bool tick(Time now);
  /// This end has had no tick for `timing.silence`: the process stood still, and the other end may have given it up.
  bool stood_still(Time now) const { return now - last_tick_ >= timing_.silence; }
  /// To be called after tick() has said true and one more read: true if that read brought nothing either.
  bool still() const { return !heard_; }

 private:
  Timing timing_;
  Time last_tick_{};
  Clock::duration quiet_{0};
  bool heard_ = true;
};

}  // namespace limb_ring::link
