#include "study/planned_ring.h"

#include "setup/core_settings.h"

namespace limb_ring::study {

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

std::unique_ptr<sim::WatchedRing> planned_ring(const RingConfig& ring) {
  sim::VirtualRingOptions options;
  options.nodes = static_cast<unsigned>(ring.nodes.size());
  options.keep_logs = false;
  options.adjust = [&ring](core::Settings& settings) { adjust(ring, settings); };
  return std::make_unique<sim::WatchedRing>(options);
}

}  // namespace limb_ring::study
