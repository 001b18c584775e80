#include "firmware/periodic.h"

namespace limb_ring::firmware {

Periodic::Periodic(double rate_hz, nanoseconds start)
    : period_(static_cast<std::int64_t>(1e9 / rate_hz)), due_(start + period_) {}

bool Periodic::take(nanoseconds now) {
  if (now < due_) return false;
  const std::int64_t late = (now - due_) / period_;
  missed_ += static_cast<std::uint64_t>(late);
  due_ += period_ * (late + 1);
  return true;
}

}  // namespace limb_ring::firmware
