#include "app/ringctl/progress.h"

#include <iostream>

namespace limb_ring::ringctl {

namespace {
constexpr std::chrono::seconds kEvery{2};
}

Progress::Progress() : next_(std::chrono::steady_clock::now() + kEvery) {}

void Progress::tell(const std::string& what) {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + kEvery;
  std::cerr << "ringctl: " << what << " ..." << std::endl;
}

}  // namespace limb_ring::ringctl
