#include "client/fixed_point.h"

#include <cmath>

namespace limb_ring::payload {

Fixed to_fixed(double value, double steps_per_unit) {
  constexpr double kMost = 2147483647.0;  // the same on both sides, so that signs can be turned
  const double steps = std::round(value * steps_per_unit);
  if (std::fabs(steps) <= kMost) return {static_cast<std::int32_t>(steps), false};
  return {static_cast<std::int32_t>(steps < 0 ? -kMost : kMost), true};
}

}  // namespace limb_ring::payload
