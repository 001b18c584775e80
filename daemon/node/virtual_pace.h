#pragma once

#include <chrono>

#include "core/time.h"

namespace limb_ring::virtual_host {

/// How fast, at most, the time of a virtual ring goes on compared with real time. If the machine is slower, the ring
/// falls behind. It catches up by at most kMostBehind; the rest is lost.
class Pace {
 public:
  using Real = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::milliseconds kMostBehind{100};

  /// @param factor virtual per real time, > 0; infinite: as fast as the machine and the programs are
  Pace(double factor, Real now) : factor_(factor), real_(now) {}

  double factor() const { return factor_; }
  /// Sets the factor from now on; the ring is at `reached`.
  void set_factor(double factor, Real now, core::Time reached);
  /// The ring's time has stood until now: it must not catch up for that.
  void restart(Real now, core::Time reached);
  /// How far the ring, which is at `reached`, may go on by now.
  core::Time allowed(Real now, core::Time reached);
  /// When the ring may reach `time`.
  Real when(core::Time time) const;
  /// How late the ring is, being at `reached` now; 0: it is not, or goes as fast as it can.
  std::chrono::nanoseconds late(Real now, core::Time reached) const;
  /// Real time that was not made up for.
  std::chrono::nanoseconds lost() const { return lost_; }

 private:
  double factor_;
  Real real_;             ///< then ...
  core::Time virtual_{};  ///< ... it was this
  std::chrono::nanoseconds lost_{0};
};

}  // namespace limb_ring::virtual_host
