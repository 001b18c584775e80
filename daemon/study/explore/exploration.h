#pragma once

#include <functional>
#include <optional>

#include "study/explore/explored_run.h"

namespace limb_ring::study {

/// Every run of a small world with at most so many strikes, each of them at every place where it can fall. A run with k
/// strikes is run again with a further strike at every place behind its last one. (ours)
class Exploration {
 public:
  /// @param most_places nothing strikes later than that in a run
  Exploration(const World& world, unsigned faults, unsigned most_places = 1'000'000)
      : world_(world), faults_(faults), most_places_(most_places) {}

  /// Runs them all, or until a promise is broken. @param progress called after every run
  void run(const std::function<void()>& progress);
  std::uint64_t runs() const { return runs_; }
  /// The largest number of places in one run.
  unsigned places() const { return places_; }
  /// The first run that broke a promise.
  struct Found {
    std::vector<Choice> choices;
    sim::Violation violation;
  };
  const std::optional<Found>& found() const { return found_; }

 private:
  void extend(std::vector<Choice>& choices, const std::function<void()>& progress);
  std::vector<Strike> strikes() const;

  World world_;
  unsigned faults_, most_places_;
  std::uint64_t runs_ = 0;
  unsigned places_ = 0;
  std::optional<Found> found_;
};

}  // namespace limb_ring::study
