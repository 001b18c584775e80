#pragma once

#include <functional>
#include <vector>

#include "node/clock_control.h"
#include "node/virtual_pace.h"
#include "sim/virtual_ring.h"

namespace limb_ring::virtual_host {

/// How far, and at which pace, the time of a virtual ring may go on. Clients can pause it, step it, or make it follow
/// an outer clock.
class Steering final : public runtime::ClockControl {
 public:
  /// @param ring outlives this
  explicit Steering(sim::VirtualRing& ring) : ring_(ring) {}
  /// Time goes on at this pace, which outlives the run.
  void use(Pace& pace) { pace_ = &pace; }
  /// Time stands until allow().
  void follow() { follows_ = true; }

  // From clients.
  State state() const override;
  void set_pace(double factor) override;
  void pause() override;
  void run() override;
  void step(nanoseconds time, std::function<void()> done) override;
  bool allow(nanoseconds until, nanoseconds outer_zero) override;
  void went_on_without(const std::string& whom) override { left_behind_ = whom; }

  /// Whom time has last gone on without; empty: nobody.
  const std::string& left_behind() const { return left_behind_; }
  core::Time limit() const;
  /// To be called when all programs wait. @return true if the ring's time has reached the limit and must stand
  bool holds();

 private:
  void end_steps();

  sim::VirtualRing& ring_;
  Pace* pace_ = nullptr;
  core::Time pause_at_ = core::kNever;
  std::vector<std::function<void()>> steps_;  ///< who waits for pause_at_
  bool follows_ = false;
  core::Time allowed_{};
  nanoseconds outer_zero_{0};
  std::string left_behind_;
};

}  // namespace limb_ring::virtual_host
