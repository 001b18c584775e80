#include "io/silence.h"

#include <algorithm>

namespace limb_ring::link {

void Silence::restart(Time now) {
  last_tick_ = now;
  quiet_ = Clock::duration::zero();
  heard_ = true;
}

bool Silence::tick(Time now) {
  const auto passed = std::min<Clock::duration>(now - last_tick_, 2 * timing_.idle);
  last_tick_ = now;
  quiet_ = heard_ ? Clock::duration::zero() : quiet_ + passed;
  heard_ = false;
  return quiet_ >= timing_.silence;
}

}  // namespace limb_ring::link
