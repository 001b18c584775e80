#pragma once

#include "tools/ringctl/ring_access.h"
#include "wire/pcapng_writer.h"

namespace limb_ring::ringctl {

/// The names of a running ring and its nodes, as captures take them.
inline capture::RingNames names_of(const RingAccess& ring) {
  capture::RingNames names{ring.ring(), {}};
  for (const NodeName& node : ring.nodes()) names.nodes[wire::NodeId{node.id}] = node.name;
  return names;
}

}  // namespace limb_ring::ringctl
