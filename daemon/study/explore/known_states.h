#pragma once

#include <cstdint>
#include <mutex>
#include <unordered_map>

namespace limb_ring::study {

/// The states in which runs were. Several threads may ask. (ours)
class KnownStates {
 public:
  /// Notes that a run is in that state. @param left how many faults may still strike from there on
  /// @return true if another run was in it with at least as many left, so that its continuations cover this run's
  bool meet(std::uint64_t state, std::uint64_t run, unsigned left) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto [place, is_new] = states_.try_emplace(state, Visit{run, left});
    Visit& visit = place->second;
    if (is_new || visit.run == run) return false;
    if (visit.left >= left) return true;
    visit = {run, left};
    return false;
  }
  /// Different ones.
  std::size_t count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return states_.size();
  }

 private:
  struct Visit {
    std::uint64_t run;
    unsigned left;
  };
  mutable std::mutex mutex_;
  std::unordered_map<std::uint64_t, Visit> states_;
};

}  // namespace limb_ring::study
