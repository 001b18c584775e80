#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/scenario_run.h"

namespace limb_ring::scenario {

/// A story that fails: events, each of which can be left out, and how it goes on after each of them.
class Story {
 public:
  virtual ~Story() = default;
  virtual std::size_t events() const = 0;
  virtual nanoseconds at(std::size_t event) const = 0;
  virtual std::string words(std::size_t event) const = 0;
  /// Whether it fails in the same way with only these events, in the order of time.
  virtual bool fails(const std::vector<std::size_t>& events) = 0;
  /// The same, and the two change places: each comes when the other one did.
  virtual bool fails_swapped(const std::vector<std::size_t>& events, std::size_t one, std::size_t other) = 0;
  /// Whether it fails in the same way if all goes as it did with the first `events` events, up to just before the next
  /// one, and then otherwise: in future 0 nothing more is done; in future 1, in the soak's world, all is mended at
  /// once, too; in each further one other things are done, by its number.
  virtual bool fails_after(std::size_t events, unsigned future) = 0;
};

/// run_scenario() under a virtual clock, with models of CPUs.
Runner simulated();

/// A failing scenario as a story. In a future above 1 each later event is left out with a probability of one half.
/// @param scenario is copied @param run runs it, and each part of it @return nothing if it does not fail
std::unique_ptr<Story> story_of(const Scenario& scenario, std::uint64_t seed, Runner run = simulated());

/// Why a story fails. (ours, after Zeller's delta debugging; and after the bisection over futures of Antithesis)
struct Cause {
  struct Needed {
    std::size_t event;
    bool alone_heals;  ///< without it, and with all others of the whole story, it does not fail
  };
  std::vector<Needed> needed;       ///< it fails with these alone, and without any of them it does not
  bool certain_from_start = false;  ///< every future fails without any event
  /// From the end of that event on every future fails; nothing: from the start, or after the last event one does not.
  std::optional<std::size_t> sealed_by;
  unsigned before = 0;                                               ///< of kFutures, how many failed before that event
  std::vector<std::pair<std::size_t, std::size_t>> healed_by_order;  ///< two needed events that must not change places
  std::size_t runs = 0;
  bool stopped = false;  ///< after kMostCauseRuns for the needed events: there may be fewer
};

constexpr unsigned kFutures = 12;
constexpr std::size_t kMostCauseRuns = 2000;

/// @param tell called after each run; throws to end it all
Cause cause_of(Story& story, const std::function<void(std::size_t runs)>& tell);

/// As a short list for people.
std::string text_of(const Cause& cause, const Story& story);

}  // namespace limb_ring::scenario
