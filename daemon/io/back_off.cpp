#include "io/back_off.h"

#include <algorithm>

namespace limb_ring::process {

BackOff::milliseconds BackOff::after(milliseconds ran) {
  if (ran >= limits_.steady) reset();
  const milliseconds wait = next_;
  next_ = std::min(next_ * 2, limits_.most);
  return wait;
}

}  // namespace limb_ring::process
