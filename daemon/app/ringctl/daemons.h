#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "app/ringctl/ring_plan.h"
#include "app/ringctl/signal_wait.h"
#include "process/exit_status.h"
#include "process/spawn.h"

namespace limb_ring::ringctl {

/// A ringd that `up` has started.
struct Daemon {
  NodeName node;
  process::Spawned process;
  std::string log;  ///< file of its output; empty: it goes to ours
  std::optional<process::ExitStatus> ended;

  /// "node 3 (left_knee) ended: exit 2", with its last words
  std::string obituary() const;
  /// The last lines of its log, each on a line of its own; empty where it has none.
  std::string last_words() const;
};

/// All daemons of a ring that `up` has started.
class Daemons {
 public:
  enum class Mode {
    foreground,  ///< they end with us, whatever ends us
    detached,    ///< they go on without us, each with a log file in the ring's folder
    kept         ///< they end with us, at once and whatever ends us; each with a log file
  };

  /// Starts one ringd per node. @throw NotDone where there is none to start
  Daemons(const RingPlan& plan, Mode mode);

  /// Notes which have ended. @return the ones that have since the last call
  std::vector<const Daemon*> reap();
  /// Starts the daemon again that has ended, as it was started before. @pre all()[index].ended
  void start_again(std::size_t index);
  bool any_running() const;
  const std::string& ring() const { return plan_.ring; }
  const std::vector<Daemon>& all() const { return daemons_; }
  const Daemon* first_ended() const;
  void signal(int number) const;
  /// Ends all: SIGTERM, after `grace`, or a second request to end, SIGKILL.
  void end(SignalWait& signals, std::chrono::milliseconds grace);

 private:
  Daemon started(const NodeName& node) const;

  RingPlan plan_;
  Mode mode_;
  std::string ringd_, folder_;
  std::vector<Daemon> daemons_;
};

}  // namespace limb_ring::ringctl
