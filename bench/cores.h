#pragma once

#include <sched.h>
#include <sys/types.h>

#include <chrono>
#include <optional>
#include <vector>

#include "bench/private_ring.h"
#include "bench/setup.h"

namespace limb_ring::bench {

/// The cores that the processes of a case may use: the last one this process may use itself (the
/// first often serves the machine's interrupts); nothing where they are free.
std::optional<cpu_set_t> cores_for(Pinning pinning);

/// How many cores this process may use.
unsigned core_count();

/// Pins the calling process to these cores; nothing: leaves it free.
void stay_on(const std::optional<cpu_set_t>& cores);

/// What processes take together from here on, in percent of one core.
class CpuShare {
 public:
  /// @throw std::runtime_error where one has ended
  explicit CpuShare(std::vector<pid_t> processes);
  /// Since the beginning. @throw std::runtime_error where one has ended
  double percent() const;

 private:
  std::vector<pid_t> processes_;
  double before_;  ///< s
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

/// What a ring takes that has nothing to do but what its configuration makes it do: percent of one
/// core, all its processes together, daemons and CPUs. Where the first node's CPU is attached, one
/// that only reads takes its place (and is not counted).
double measure_idle_percent(const Setup& setup, PrivateRing& ring);

}  // namespace limb_ring::bench
