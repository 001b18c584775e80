#pragma once

#include <stdexcept>

#include "sim/invariants.h"

namespace limb_ring::sim {

/// A promise of the ring was broken: which, when in virtual time, and the packets involved.
struct BrokenPromise : std::runtime_error {
  explicit BrokenPromise(const Violation& violation)
      : std::runtime_error("promise broken at " + std::to_string(core::picoseconds(violation.at.time_since_epoch())) +
                           " ps: " + to_string(violation.promise) + ": " + violation.what) {}
};

/// A virtual ring whose every promise is checked at every event.
class WatchedRing : public VirtualRing {
 public:
  explicit WatchedRing(const VirtualRingOptions& options) : VirtualRing(options), invariants_(*this) {}

  const std::optional<Violation>& violation() const { return invariants_.violation(); }
  /// @throw BrokenPromise
  void check() const {
    if (violation()) throw BrokenPromise(*violation());
  }

 private:
  Invariants invariants_;
};

}  // namespace limb_ring::sim
