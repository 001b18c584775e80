#include "firmware/state_destination.h"

namespace limb_ring::firmware {

std::uint8_t state_destination(const config::RingConfig& ring) {
  for (const auto& node : ring.nodes)
    if (node.cpu.kind == config::CpuConfig::Kind::attached) return node.id;
  return ring.nodes.front().id;
}

}  // namespace limb_ring::firmware
