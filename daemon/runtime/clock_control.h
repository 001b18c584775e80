#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace limb_ring::runtime {

/// What clients may ask of a ring's virtual clock: none of it changes what happens on the ring at which instant.
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
  /// Pauses so much later than now; `done` is called once, when it has, or somebody has asked for something else.
  virtual void step(nanoseconds time, std::function<void()> done) = 0;
  /// The outer clock has come so far. @return false where this ring does not follow one
  virtual bool allow(nanoseconds until, nanoseconds outer_zero) = 0;
  /// Time has gone on without somebody who should have been waited for: the run would be another one next time.
  virtual void went_on_without(const std::string& whom) = 0;
};

}  // namespace limb_ring::runtime
