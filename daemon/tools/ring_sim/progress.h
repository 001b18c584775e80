#pragma once

#include <chrono>
#include <iostream>
#include <string>

namespace limb_ring::ring_sim {

/// Says on standard error what is being done, every two seconds, once it takes longer than that.
class Progress {
 public:
  void tell(const std::string& what) {
    const auto now = Clock::now();
    if (now < next_) return;
    next_ = now + kQuiet;
    std::cerr << "ring_sim: " << what << " ..." << std::endl;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kQuiet{2};
  Clock::time_point next_ = Clock::now() + kQuiet;
};

}  // namespace limb_ring::ring_sim
