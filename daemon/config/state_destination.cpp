#include "config/state_destination.h"

namespace limb_ring::config {

std::uint8_t state_destination(const RingConfig& ring) {
  for (const NodeConfig& node : ring.nodes)
    if (node.cpu.kind == CpuConfig::Kind::attached) return node.id;
  return ring.nodes.front().id;
}

}  // namespace limb_ring::config
