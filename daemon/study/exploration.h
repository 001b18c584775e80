#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>

#include "study/explored_run.h"

namespace limb_ring::study {

/// Every run of a small world with at most Bounds::faults strikes, each of them at every place where it can fall. A run
/// with k strikes is run again with a further strike at every place after its last one. A run that reaches a state of
/// an earlier run ends there: the earlier run, and those that begin like it, cover all that could follow. (ours)
class Exploration {
 public:
  struct Bounds {
    unsigned faults = 1;
    unsigned places = kAllPlaces;  ///< nothing strikes later than that in a run
    bool recognise = true;         ///< states that were met before
    unsigned threads = 1;          ///< with more of them another broken promise may be found first
  };
  static constexpr unsigned kAllPlaces = 1'000'000;

  Exploration(const World& world, const Bounds& bounds) : world_(world), bounds_(bounds) {}

  /// Runs them all, or until a promise is broken or stop() is called.
  /// @param progress called after every run, by one thread at a time
  void run(const std::function<void()>& progress);
  /// Begins no further run. May be called by `progress`.
  void stop() { stop_ = true; }
  std::uint64_t runs() const { return runs_; }
  /// Runs that ended in a state that had been met before.
  std::uint64_t recognised() const { return recognised_; }
  /// The number of different states that were seen.
  std::size_t states() const { return states_.count(); }
  /// The largest number of places in one run.
  unsigned places() const { return places_; }
  /// The first run that broke a promise.
  struct Found {
    std::vector<Choice> choices;
    sim::Violation violation;
  };
  const std::optional<Found>& found() const { return found_; }

 private:
  using Progress = std::function<void()>;

  unsigned run_once(const std::vector<Choice>& choices, const Progress& progress);
  void extend(std::vector<Choice>& choices, const Progress& progress);
  std::vector<Choice> next(const std::vector<Choice>& choices, unsigned places) const;
  std::vector<Strike> strikes() const;

  World world_;
  Bounds bounds_;
  KnownStates states_;
  std::atomic<std::uint64_t> begun_{0};  ///< runs
  std::atomic<bool> stop_{false};
  std::mutex mutex_;  ///< over what follows
  std::uint64_t runs_ = 0, recognised_ = 0;
  unsigned places_ = 0;
  std::optional<Found> found_;
};

}  // namespace limb_ring::study
