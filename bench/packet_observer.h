#pragma once

#include <atomic>
#include <memory>

#include "bench/private_ring.h"
#include "bench/shared.h"
#include "bench/worker.h"

namespace limb_ring::bench {

/// A process that observes all packets that come into one node, as `ringctl traffic show NODE -w` does, and throws away
/// what it would write.
class PacketObserver {
 public:
  /// Returns when it observes. @throw std::runtime_error where that takes too long
  PacketObserver(const Setup& setup, const PrivateRing& ring, std::size_t index, Pinning pinning);

 private:
  std::unique_ptr<Shared<std::atomic<bool>>> ready_;
  std::unique_ptr<Worker> worker_;
};

}  // namespace limb_ring::bench
