#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>

#include "bench/measurement.h"
#include "bench/private_ring.h"
#include "bench/setup.h"
#include "io/child.h"
#include "ring/launched_ring.h"

namespace limb_ring::bench {

/// Writes the configuration of a plain ring whose first node, and the one across, have CPUs that
/// connect from outside. @return its path
std::string write_two_cpus(const Setup& setup, const live::PrivateFolder& folder);

/// From one CPU to the other and back: two packets, each through both host ports, half a lap each
/// way. The CPUs are processes of their own. @pre `ring` was made from write_two_cpus()
Measurement measure_cpu_to_cpu(const Setup& setup, const PrivateRing& ring, Pinning pinning);

/// A forked copy of this process that does one thing and ends. It ends with us at the latest.
class Worker {
 public:
  /// What `work` throws is told on standard error.
  explicit Worker(const std::function<void()>& work);
  ~Worker();
  Worker(Worker&& other) noexcept = default;
  Worker& operator=(Worker&&) = delete;

  bool running();
  /// Waits until the worker sets `flag`, calling `poll` all the while. @return false if it has not within
  /// `patience`, or has ended without
  bool sets(const std::atomic<bool>& flag, const std::function<void()>& poll, std::chrono::milliseconds patience);

 private:
  std::unique_ptr<process::Child> child_;  ///< none: moved to another
};

/// Data packets made and timed in the daemons, from first byte out to matched return, each node
/// keeping one outstanding, to the node on the other side of the ring.
Measurement measure_traffic(const Setup& setup, const PrivateRing& ring, Sending sending);

/// A process that judges the ring's promises, as `ringctl traffic judge` does.
class RingJudge {
 public:
  /// Returns when it watches all nodes. @throw std::runtime_error if that takes too long
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
  /// Returns when the page has been told a status. @throw std::runtime_error if that takes too long
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
  /// Returns when it observes. @throw std::runtime_error if that takes too long
  PacketObserver(const Setup& setup, const PrivateRing& ring, std::size_t index, Pinning pinning);

 private:
  std::unique_ptr<Shared<std::atomic<bool>>> ready_;
  std::unique_ptr<Worker> worker_;
};

}  // namespace limb_ring::bench
