#pragma once

#include <sys/types.h>

#include <chrono>
#include <vector>

namespace limb_ring::bench {

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

}  // namespace limb_ring::bench
