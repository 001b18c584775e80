#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace limb_ring::runtime {

/// What clients may ask of a ring's virtual clock. Nothing here changes what happens on the ring, or at which instant
/// of its time.
class ClockControl {
 public:
  using nanoseconds = std::chrono::nanoseconds;
  struct State {
    nanoseconds now{0};
    double pace = 1;      ///< the ring's time per real time; infinite: as fast as the machine and the programs are
    nanoseconds late{0};  ///< behind real time at that pace
    nanoseconds lost{0};  ///< real time that the machine was too slow for, and that is not made up for
    bool paused = false;
    bool follows = false;       ///< it goes on no further than allow() has said
    nanoseconds allowed{0};     ///< where it follows
    nanoseconds outer_zero{0};  ///< where it follows: what the outer clock shows at 0 of the ring's
  };

  virtual ~ClockControl() = default;
  virtual State state() const = 0;
  virtual void set_pace(double factor) = 0;
  virtual void pause() = 0;
  /// Goes on after a pause.
  virtual void run() = 0;
  /// Pauses after another `time`. `done` is called once: when the clock has paused, or another request has replaced
  /// this one.
  virtual void step(nanoseconds time, std::function<void()> done) = 0;
  /// The outer clock has reached `until`, in ns of the ring's time. @return false if this ring follows no outer clock
  /// @param outer_zero what the outer clock shows at 0 of the ring's
  virtual bool allow(nanoseconds until, nanoseconds outer_zero) = 0;
  /// Time has gone on although `whom` should have been waited for, so the run is not repeatable.
  virtual void went_on_without(const std::string& whom) = 0;
};

}  // namespace limb_ring::runtime
