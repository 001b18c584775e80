#include "sim/planned_ring.h"

#include <algorithm>

#include "config/core_settings.h"

namespace limb_ring::sim {

namespace {

using config::RingConfig;
using wire::NodeId;

NodeId place_of(const RingConfig& ring, NodeId id) {
  return static_cast<NodeId>(setup::index_of(ring, *ring.find(id)));
}

void adjust(const RingConfig& ring, core::Settings& settings) {
  const core::Settings given = settings;
  settings = setup::core_settings(ring, ring.nodes[given.id], given.boot);
  settings.id = given.id;
  settings.order = given.order;
  for (auto& input : settings.inputs)
    if (input && input->destination != wire::kBroadcast) input->destination = place_of(ring, input->destination);
}

}  // namespace

std::unique_ptr<WatchedRing> planned_ring(const RingConfig& ring) {
  VirtualRingOptions options;
  options.nodes = static_cast<unsigned>(ring.nodes.size());
  options.keep_logs = false;
  options.adjust = [&ring](core::Settings& settings) { adjust(ring, settings); };
  return std::make_unique<WatchedRing>(options);
}

bool assumes_lines(const RingConfig& ring) {
  return std::any_of(ring.nodes.begin(), ring.nodes.end(), [](const auto& node) { return node.link.rate == 0; });
}

RingConfig with_assumed_lines(RingConfig ring, std::uint64_t rate, std::chrono::nanoseconds delay) {
  for (config::NodeConfig& node : ring.nodes) {
    if (node.link.rate != 0) continue;
    node.link.rate = rate;
    node.link.delay = delay;
  }
  return ring;
}

}  // namespace limb_ring::sim
