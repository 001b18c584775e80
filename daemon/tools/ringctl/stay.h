#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "io/child.h"
#include "io/program.h"
#include "io/signal_wait.h"
#include "ring/launched_ring.h"
#include "tools/ringctl/up.h"
#include "tools/ringctl/wait.h"

namespace limb_ring::ringctl {

/// Says that the ring, or this host's part of it, is up; of a part that is refused by the others, why.
void announce(const RingPlan& plan, RingWatch& watch);

/// A second request to end kills at once.
void end(live::LaunchedRing& daemons, process::SignalWait& signals);

/// Saves recordings when something goes wrong, if the ring's file says so; ends with the ring.
/// @param lifetime its own: it writes into keep.log in the ring's folder
std::optional<process::Program> start_keeper(const RingPlan& plan, process::Lifetime lifetime);

/// Until a signal, or until all daemons have ended by themselves (ringctl down).
/// @param has_end the ring ends when its time is over; its folder goes then, unless 'ringctl down' has removed it
/// @return an ExitCode
int stay(const RingPlan& plan, live::LaunchedRing& daemons, process::SignalWait& signals, bool has_end);

/// Starts the ring and stays until a signal, whatever ends the daemons. @return an ExitCode
/// @throw NotDone if one cannot start
int respawn(const RingPlan& plan, UpLock& lock);

/// Restarts daemons of a ring that end by themselves, each after a pause that grows while it keeps ending.
/// A daemon that somebody has ended on purpose stays down: by 'ringctl down', by SIGTERM, or by 'ringctl fault kill'.
/// After the last, 'fault start' or 'fault clear' starts a daemon that is not a child of ours; if that one dies, it is
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
