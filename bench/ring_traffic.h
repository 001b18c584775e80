#pragma once

#include <atomic>
#include <memory>

#include "bench/cpu_to_cpu.h"
#include "bench/measurement.h"
#include "bench/private_ring.h"
#include "bench/setup.h"

namespace limb_ring::bench {

/// Data packets made and timed in the daemons, from first byte out to matched return, each node
/// keeping one outstanding, to the node on the other side of the ring.
Measurement measure_traffic(const Setup& setup, const PrivateRing& ring, Sending sending);

/// A process that judges the ring's promises, as `ringctl traffic judge` does.
class RingJudge {
 public:
  /// Returns when it watches all nodes. @throw std::runtime_error where that takes too long
  RingJudge(const Setup& setup, const PrivateRing& ring, Pinning pinning);
  /// @throw std::runtime_error if it found a broken promise: the measurement is void then
  void require_valid() const;

 private:
  struct Seen {
    std::atomic<bool> ready{false};
    std::atomic<bool> broken{false};
  };
  std::unique_ptr<Shared<Seen>> seen_;
  std::unique_ptr<Worker> worker_;
};

/// `ringctl view`, and a process that takes what its page would, as fast as it comes; a real browser would also draw.
class RingLook {
 public:
  /// Returns when the page has been told a status. @throw std::runtime_error where that takes too long
  RingLook(const Setup& setup, const PrivateRing& ring, Pinning pinning);
  /// @throw std::runtime_error if it was told nothing more: the measurement is void then
  void require_valid() const;

 private:
  struct Seen {
    std::atomic<bool> ready{false};
    std::atomic<bool> ended{false};
  };
  std::unique_ptr<Shared<Seen>> seen_;
  std::unique_ptr<Worker> worker_;
};

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
