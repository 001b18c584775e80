#pragma once

#include <chrono>
#include <string>

namespace limb_ring::ringctl {

/// Says on standard error what is being waited for, once it takes longer than two seconds, and
/// then every two seconds.
class Progress {
 public:
  Progress();
  void tell(const std::string& what);

 private:
  std::chrono::steady_clock::time_point next_;
};

}  // namespace limb_ring::ringctl
