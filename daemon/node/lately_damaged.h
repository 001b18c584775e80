#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

#include "core/counters.h"
#include "core/time.h"

namespace limb_ring::runtime {

/// The damaged packets that came in within the last 10 s: what a line is now. Counters only tell what it has ever been.
/// (ours)
class LatelyDamaged {
 public:
  static constexpr std::chrono::seconds kWindow{10};
  struct Counts {
    std::uint64_t crc_errors = 0, returns_damaged = 0;
    core::Duration oldest{0};  ///< since the first of them; one second is counted as a whole
  };

  void look(core::Time now, const core::Counters& counters) {
    if (counters.crc_errors == crc_errors_ && counters.returns_damaged == returns_damaged_) return;
    if (seconds_.empty() || now - seconds_.back().begin >= std::chrono::seconds(1)) seconds_.push_back({now, 0, 0});
    while (now - seconds_.front().begin > kWindow) seconds_.pop_front();
    seconds_.back().crc_errors += counters.crc_errors - crc_errors_;
    seconds_.back().returns_damaged += counters.returns_damaged - returns_damaged_;
    crc_errors_ = counters.crc_errors;
    returns_damaged_ = counters.returns_damaged;
  }

  Counts counts(core::Time now) const {
    Counts all;
    for (auto second = seconds_.rbegin(); second != seconds_.rend() && now - second->begin <= kWindow; ++second) {
      all.crc_errors += second->crc_errors;
      all.returns_damaged += second->returns_damaged;
      all.oldest = now - second->begin;
    }
    return all;
  }

 private:
  struct Second {
    core::Time begin;
    std::uint64_t crc_errors, returns_damaged;
  };
  std::deque<Second> seconds_;
  std::uint64_t crc_errors_ = 0, returns_damaged_ = 0;
};

}  // namespace limb_ring::runtime
