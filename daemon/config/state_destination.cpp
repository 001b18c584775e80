#include "config/state_destination.h"

namespace limb_ring::config {

std::uint8_t state_destination(const RingConfig& ring) {
  return body_of(ring).id;
}

}  // namespace limb_ring::config
