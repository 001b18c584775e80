#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "judge/observation_file.h"
#include "judge/promise_judge.h"
#include "ring/observed_daemon.h"

namespace limb_ring::live {

/// Judges the promises of a living ring from its daemons' observations. Nodes may die, stop and come back. (ours)
class PromiseWatch {
 public:
  /// The period at which poll() is to be called; a broken promise is reported within a second.
  static constexpr std::chrono::milliseconds kRound{50};

  struct Ring {
    std::string name;
    std::vector<std::uint8_t> nodes;  ///< of this host
    bool folds_back = false;
    std::string runtime = {};  ///< as ConnectOptions
  };
  PromiseWatch(const Ring& ring, promises::PromiseJudge::OnBreach on_breach);

  /// Reads from all connected nodes and looks for the others. May wait 400 ms for each that does not answer.
  /// @throw NotDone once for each node that cannot be observed; the others are, in the next poll()
  void poll();
  /// Reads what is left, and judges it: some rounds more.
  void finish();
  /// Nodes that are being looked at.
  std::size_t watched() const;
  /// A node whose daemon lives, or may, and is not looked at.
  struct Unwatched {
    std::uint8_t node;
    std::string why;
  };
  std::vector<Unwatched> unwatched() const;
  const promises::JudgeCounts& counts() const { return judge_.counts(); }
  /// The instant of a breach since 1970; on a virtual ring by its own clock.
  std::chrono::nanoseconds date(std::int64_t at_ns) const { return std::chrono::nanoseconds(at_ns) + to_date_; }

 private:
  struct Node {
    std::uint8_t id;
    ObservedDaemon daemon;
    std::unique_ptr<promises::ObservationReader> reader = nullptr;
    int last_rounds = 0;       ///< until it counts as dead
    std::string problem = {};  ///< why its observations cannot be read
  };

  void hear(Node& node);
  void begin(Node& node, const std::string& message);
  void read(Node& node);

  promises::PromiseJudge judge_;
  std::vector<Node> nodes_;
  std::vector<promises::Observation> seen_;
  std::chrono::nanoseconds to_date_{0};
};

}  // namespace limb_ring::live
