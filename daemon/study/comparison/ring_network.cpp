#include "study/comparison/ring_network.h"

#include <algorithm>

#include "sim/watched_ring.h"
#include "study/analysis/model_ring.h"
#include "study/analysis/pulse.h"
#include "study/analysis/ring_bounds.h"
#include "study/comparison/ring_feed.h"

namespace limb_ring::study {

namespace {

/// Every node but the last sends to its successor for ever.
void load_fully(sim::VirtualRing& ring, const Medium& medium) {
  const std::vector<std::uint8_t> data(medium.payload);
  const unsigned nodes = medium.nodes;
  const auto send = [&ring, nodes, data](NodeId id) { ring.send(id, static_cast<NodeId>((id + 1u) % nodes), data); };
  ring.on_event = [send](NodeId id, const core::Event& event) {
    const auto* end = std::get_if<core::SendEnded>(&event.what);
    if (end && end->outcome != core::Outcome::rejected) send(id);
  };
  for (unsigned id = 0; id < nodes; ++id) send(static_cast<NodeId>(id));
}

}  // namespace

std::vector<Time> RingNetwork::carry(const Medium& medium, const std::vector<Message>& messages, Time until) const {
  sim::WatchedRing ring(ring_options(medium));
  const Pulse pulse(ring, goes_on_);
  join_and_settle(ring, medium);
  RingFeed feed(ring, messages);
  // `until` counts from now, so kNever would overflow the ring's own clock: hence the limit.
  const Duration left = core::kNever - ring.now();
  ring.run_until([&feed] { return feed.done(); }, std::min(until - Time{}, left));
  ring.check();
  return feed.delivered(until);
}

Duration RingNetwork::time_to_join_after(const Medium& medium, Duration wait) const {
  Medium grown = medium;
  ++grown.nodes;
  sim::VirtualRingOptions options = ring_options(grown);
  options.start = false;
  sim::WatchedRing ring(options);
  const Pulse pulse(ring, goes_on_);
  for (unsigned id = 0; id < medium.nodes; ++id) ring.start(static_cast<NodeId>(id));
  join(ring);
  load_fully(ring, medium);
  ring.run_for(wait);
  const auto newcomer = static_cast<NodeId>(medium.nodes);
  const Time on = ring.now();
  ring.start(newcomer);
  join(ring);
  ring.check();
  return ring.now() - on;
}

Duration RingNetwork::time_to_join(const Medium& medium) const {
  constexpr int kInstants = 8, kLapsBefore = 4;
  const Duration lap = data_bound(medium, medium.nodes);
  Duration longest{0};
  for (int i = 0; i < kInstants; ++i)
    longest = std::max(longest, time_to_join_after(medium, kLapsBefore * lap + i * lap / kInstants));
  return longest;
}

}  // namespace limb_ring::study
