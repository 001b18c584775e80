#pragma once

#include <algorithm>
#include <array>

#include "core/time.h"

namespace limb_ring::core {

/// When each timer of a block ends. `Timer` is an enum of them, whose last is `count`. A timer that has ended stays due
/// until it is started again or stopped. (ours)
template <class Timer>
class Timers {
 public:
  Timers() { stop_all(); }
  /// kNever: it does not run.
  Time operator[](Timer timer) const { return ends_[static_cast<std::size_t>(timer)]; }
  bool runs(Timer timer) const { return (*this)[timer] != kNever; }
  bool due(Timer timer, Time now) const { return (*this)[timer] <= now; }
  void start(Timer timer, Time end) { ends_[static_cast<std::size_t>(timer)] = end; }
  void stop(Timer timer) { start(timer, kNever); }
  void stop_all() { ends_.fill(kNever); }
  /// The earliest end.
  Time next() const { return *std::min_element(ends_.begin(), ends_.end()); }

  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("ends", ends_);
  }

 private:
  std::array<Time, static_cast<std::size_t>(Timer::count)> ends_;
};

}  // namespace limb_ring::core
