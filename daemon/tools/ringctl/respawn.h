#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "io/back_off.h"
#include "ring/launched_ring.h"

namespace limb_ring::ringctl {

/// Restarts daemons of a ring that end by themselves, each after a pause that grows while it keeps ending.
/// A daemon that somebody has ended on purpose stays down: by 'ringctl down', by SIGTERM, or by 'ringctl fault kill'.
/// After the last, 'fault start' or 'fault clear' starts a daemon that is no child of ours; if that one dies, it is
/// restarted after 8 s.
class Respawn {
 public:
  explicit Respawn(live::LaunchedRing& daemons);

  /// Reaps, tells on standard error what has ended, and starts what is due. To be called every `kTick`.
  void poll();
  /// No daemon runs, and none is to be started again.
  bool taken_down() const;

  static constexpr std::chrono::milliseconds kTick{100};

 private:
  using Clock = std::chrono::steady_clock;
  enum class Plan { runs, starts_again, stays_down };
  struct Node {
    Plan plan = Plan::runs;
    Clock::time_point started{};
    Clock::time_point due{};  ///< starts_again: not before
    process::BackOff pause;
    bool told = false;  ///< starts_again: that it waits, being killed on purpose
  };

  void ended(std::size_t index);
  void consider(std::size_t index);
  void start(std::size_t index);

  live::LaunchedRing& daemons_;
  std::string folder_;
  std::vector<Node> nodes_;
};

}  // namespace limb_ring::ringctl
