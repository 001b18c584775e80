#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>

#include "bench/measurement.h"
#include "bench/private_ring.h"
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
  /// Waits until the worker sets `flag`, calling `poll` all the while. @return false where it has not within
  /// `patience`, or has ended without
  bool sets(const std::atomic<bool>& flag, const std::function<void()>& poll, std::chrono::milliseconds patience);

 private:
  std::unique_ptr<process::Child> child_;  ///< none: moved to another
};

}  // namespace limb_ring::bench
