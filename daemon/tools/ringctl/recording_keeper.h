#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ring/observed_daemon.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/ring_folder.h"

namespace limb_ring::ringctl {

/// Saves the recordings of a ring's nodes when something goes wrong, a bounded number of times. (ours)
class RecordingKeeper {
 public:
  struct Options {
    std::set<std::string> when;  ///< of "crash", "break", "promise"
    std::string folder;          ///< each save is a folder in it
    unsigned keep = 5;           ///< so many saves of this ring; older ones are removed
  };
  /// How often poll() is to be called.
  static constexpr std::chrono::milliseconds kRound = live::PromiseWatch::kRound;

  RecordingKeeper(const RingAccess& ring, Options options);

  /// Looks what has happened, and saves; tells on standard error where, or why it cannot.
  void poll();
  /// The ring was taken down.
  bool ring_is_gone() const { return folder_.is_gone(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Node {
    NodeName name;
    pid_t pid = -1;  ///< of its daemon, while it lives, or has not been looked for
    live::ObservedDaemon states;
  };

  void judge();
  void look_for_crash(Node& node);
  void look_for_breaks(Node& node);
  void hear(const std::string& text);
  /// Saves a little later, so that the consequences are recorded as well.
  void want(const std::string& what, const std::string& words);
  void save();

  std::string ring_;
  RingFolder folder_;
  Options options_;
  std::vector<Node> nodes_;
  std::set<std::pair<int, int>> broken_;  ///< lines that are, by the nodes at their ends
  std::optional<live::PromiseWatch> watch_;
  std::string wanted_, words_;  ///< empty: nothing
  Clock::time_point due_{};
  std::optional<Clock::time_point> last_;  ///< save
};

}  // namespace limb_ring::ringctl
