#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "io/endpoint.h"

namespace limb_ring::link {

/// Chooses whom our output goes to: the nearest living node in ring order (bypass, protocol.md
/// section 6.9; the rules are ours). No IO: told what happened, it says whom to try next.
///
/// Candidates are numbered in ring order, 0 being the configured successor and the last one
/// ourselves. A candidate is passed over when nobody is there, or when it leaves an attempt
/// unanswered for `silence`. One that is busy is alive, and nobody beyond a living node is tried:
/// then our line is cut, and the ring is an open chain.
class Successor {
 public:
  Successor(std::size_t candidates, const Timing& timing, Time now);

  /// The next one to be tried now; it counts as being tried from here on.
  std::optional<std::size_t> next(Time now);

  void absent(std::size_t candidate, Time now);  ///< nobody there, or no node of this ring
  void busy(std::size_t candidate, Time now);    ///< alive, with a nearer upstream than us
  /// It says so itself. Nobody is nearer to the configured successor than we are: if it says so for kBelieved it is
  /// passed over like one that is not there. @return false: it is not believed any more
  bool says_busy(std::size_t candidate, Time now);
  static constexpr std::chrono::seconds kBelieved{10};  ///< longer than a node takes to start
  /// Is in use from here on. @pre it is nearer than the one that was
  void accepted(std::size_t candidate, Time now);
  enum class Loss { ended, silent, replaced };
  void lost(Loss loss, Time now);  ///< the one in use

  std::optional<std::size_t> current() const { return current_; }

 private:
  struct Candidate {
    enum class State { untried, trying, absent, busy } state = State::untried;
    Time since{};          ///< trying: since when; else: not again before
    bool missing = false;  ///< was not there when last tried: passed over while tried again
  };

  std::size_t farthest(Time now) const;
  bool passed_over(const Candidate& candidate, Time now) const;
  void set(std::size_t candidate, Candidate::State state, Time since, bool missing = false);

  Timing timing_;
  std::vector<Candidate> candidates_;
  std::optional<std::size_t> current_;
  std::optional<Time> patience_;  ///< at start: the configured successor only, until then
  Time up_since_{};
  std::optional<Time> first_busy_since_;  ///< says the configured successor, and nothing else since
};

}  // namespace limb_ring::link
