#include "wire/selection.h"

namespace limb_ring::capture {

bool Selection::takes(const PacketView& packet) {
  ++counts_.seen;
  if (!choice_.filter.passes(packet)) {
    ++counts_.filtered;
    return false;
  }
  if (passed_++ % choice_.sample != 0) {
    ++counts_.sampled_out;
    return false;
  }
  if (within_limit(packet.at)) return true;
  ++counts_.limited;
  return false;
}

bool Selection::within_limit(std::chrono::nanoseconds at) {
  if (choice_.limit_per_s == 0) return true;
  const std::int64_t second = std::chrono::duration_cast<std::chrono::seconds>(at).count();
  if (second != second_) in_second_ = 0;
  second_ = second;
  return in_second_++ < choice_.limit_per_s;
}

}  // namespace limb_ring::capture
