#include "tools/ringctl/tell_user.h"

#include <iostream>

namespace limb_ring::ringctl {

void tell_user(const std::string& what) { std::cerr << "ringctl: " << what << std::endl; }

void tell_standstill(std::chrono::nanoseconds time) {
  if (time.count() == 0) return;
  const auto seconds = std::to_string(std::chrono::duration_cast<std::chrono::seconds>(time).count());
  tell_user("stood still for " + seconds + " s; goes on that much later");
}

}  // namespace limb_ring::ringctl
