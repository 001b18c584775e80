#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <vector>

namespace limb_ring::bridge {

/// Calls that come back once in each of their periods, at absolute deadlines of a clock whose time is given. A late one
/// is called once; what it has missed is left out, not made up for: nobody wants old states in a burst.
class PeriodicCalls {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = Time::duration;

  /// @param phase so long after the multiples of the period since the clock's zero; none: the periods begin now
  void add(Duration period, std::optional<Duration> phase, std::function<void()> call, Time now);
  /// The clock is another one from now on.
  void restart(Time now);
  /// The first deadline; Time::max() where there is no call.
  Time next_due() const;
  /// Calls what is due.
  void run(Time now);

 private:
  struct Call {
    Duration period;
    std::optional<Duration> phase;
    std::function<void()> call;
    Time due;
  };
  static Time first_due(const Call& call, Time now);

  std::vector<Call> calls_;
};

}  // namespace limb_ring::bridge
