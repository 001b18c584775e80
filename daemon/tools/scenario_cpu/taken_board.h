#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "io/regular_file.h"

namespace limb_ring::scenario_cpu {

/// How many packets the CPU of one node has taken, by the first byte of their data: a file in the ring's folder,
/// written by the CPU and read by the scenario. It outlives the CPU's process, so that no reset loses a count. (ours)
class TakenBoard {
 public:
  /// Makes the file if there is none. @throw std::runtime_error naming it
  TakenBoard(const std::string& ring, std::uint8_t node);

  void count(std::uint8_t mark) { counts_[mark].fetch_add(1, std::memory_order_relaxed); }
  std::uint64_t of(std::uint8_t mark) const { return counts_[mark].load(std::memory_order_relaxed); }

 private:
  using Count = std::atomic<std::uint64_t>;
  static_assert(Count::is_always_lock_free, "two processes count in shared memory");

  process::MappedFile file_;
  Count* counts_;
};

}  // namespace limb_ring::scenario_cpu
