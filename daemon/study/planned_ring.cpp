#include "study/planned_ring.h"

#include <algorithm>

#include "setup/core_settings.h"

namespace limb_ring::study {

namespace {

using config::RingConfig;
using sim::NodeId;
using sim::VirtualRing;

core::Duration delay_behind(const RingConfig& ring, std::size_t node) {
  return ring.nodes[(node + 1) % ring.nodes.size()].link.delay;
}

core::Duration least_delay(const RingConfig& ring) {
  core::Duration least = delay_behind(ring, 0);
  for (std::size_t n = 1; n < ring.nodes.size(); ++n) least = std::min(least, delay_behind(ring, n));
  return least;
}

void adjust(const RingConfig& ring, core::Settings& settings) {
  const core::Settings given = settings;
  settings = setup::core_settings(ring, ring.nodes[given.id], given.boot);
  settings.id = given.id;
  settings.order = given.order;
  settings.inputs = {};  // they name ids; what pulls them is not simulated
}

/// The virtual ring has one delay for all lines, the least: what goes onto a longer one is kept back.
void lengthen(VirtualRing& ring, NodeId node, NodeId next, core::Duration delay) {
  ring.tap(node, [&ring, next, delay](const wire::Slice& slice, core::Time now, wire::SliceWriter&) {
    const std::vector<std::uint8_t> bytes(slice.bytes.begin(), slice.bytes.end());
    ring.at(now + delay, [&ring, next, bytes, kind = slice.kind] {
      ring.node(next).receive({kind, {bytes.data(), bytes.size()}}, ring.now());
    });
  });
}

}  // namespace

std::unique_ptr<VirtualRing> planned_ring(const RingConfig& ring) {
  sim::VirtualRingOptions options;
  options.nodes = static_cast<unsigned>(ring.nodes.size());
  options.relay_delay = least_delay(ring);
  options.adjust = [&ring](core::Settings& settings) { adjust(ring, settings); };
  auto made = std::make_unique<VirtualRing>(options);
  for (std::size_t n = 0; n < ring.nodes.size(); ++n)
    if (delay_behind(ring, n) != options.relay_delay)
      lengthen(*made, static_cast<NodeId>(n), static_cast<NodeId>((n + 1) % ring.nodes.size()), delay_behind(ring, n));
  return made;
}

}  // namespace limb_ring::study
