#pragma once

#include <atomic>
#include <memory>

#include "bench/private_ring.h"
#include "bench/shared.h"
#include "bench/worker.h"

namespace limb_ring::bench {

/// A process that judges the ring's promises, as `ringctl judge` does.
class RingJudge {
 public:
  /// Returns when it watches all nodes. @throw std::runtime_error where that takes too long
  RingJudge(const Setup& setup, const PrivateRing& ring, Pinning pinning);
  /// @throw std::runtime_error if it found a broken promise: the measurement is void then
  void require_kept() const;

 private:
  struct Seen {
    std::atomic<bool> ready{false};
    std::atomic<bool> broken{false};
  };
  std::unique_ptr<Shared<Seen>> seen_;
  std::unique_ptr<Worker> worker_;
};

}  // namespace limb_ring::bench
