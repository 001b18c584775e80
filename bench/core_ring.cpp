#include "core_ring.h"

#include <memory>
#include <random>
#include <stdexcept>
#include <vector>

#include "load.h"
#include "sim/invariants.h"
#include "sim/virtual_ring.h"
#include "stopwatch.h"

namespace limb_ring::hops {

namespace {

using wire::NodeId;

/// In which every node gives one packet onto its line.
std::chrono::nanoseconds lap_of(unsigned nodes) { return kPacket * static_cast<int>(nodes); }

sim::VirtualRingOptions options_for(unsigned nodes) {
  sim::VirtualRingOptions options;
  options.nodes = nodes;
  options.byte_time = kByte;
  options.relay_delay = kDelay;
  options.keep_logs = false;
  options.adjust = [](core::Settings& settings) { settings.send_timeout_least = core::Duration{0}; };
  return options;
}

std::uint64_t carried(const sim::VirtualRing& ring) {
  std::uint64_t hops = 0;
  for (unsigned id = 0; id < ring.size(); ++id) {
    const core::Counters& counters = ring.counters(static_cast<NodeId>(id));
    hops += counters.relayed_data + counters.sent_data;
  }
  return hops;
}

/// Every node sends to the one opposite, and again whenever its packet is back. They begin at random within a lap, as
/// CPUs do: where all begin in one instant they stay in step, and the clock has a tenth of the instants to visit.
void keep_busy(sim::VirtualRing& ring) {
  const auto send = [&ring, data = std::vector<std::uint8_t>(kPayload, 0x5A)](NodeId id) {
    ring.send(id, static_cast<NodeId>((id + ring.size() / 2) % ring.size()), data);
  };
  ring.on_event = [send](NodeId id, const core::Event& event) {
    const auto* ended = std::get_if<core::SendEnded>(&event.what);
    if (!ended) return;
    if (ended->outcome != core::Outcome::delivered) throw std::runtime_error("the core did not deliver a packet");
    send(id);
  };
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<std::int64_t> within_lap(0, lap_of(ring.size()).count());
  for (unsigned id = 0; id < ring.size(); ++id)
    ring.at(ring.now() + std::chrono::nanoseconds(within_lap(random)), [send, id] { send(static_cast<NodeId>(id)); });
}

}  // namespace

double core_ring(unsigned nodes, std::uint64_t hops, bool invariants) {
  sim::VirtualRing ring(options_for(nodes));
  std::unique_ptr<sim::Invariants> checks;
  if (invariants) checks = std::make_unique<sim::Invariants>(ring);
  ring.join();
  keep_busy(ring);
  ring.run_for(lap_of(nodes) * kLapsBefore);
  const std::uint64_t before = carried(ring);
  const Stopwatch watch;
  while (carried(ring) - before < hops) ring.run_for(lap_of(nodes));
  const double seconds = watch.seconds();
  if (checks && checks->violation()) throw std::runtime_error("invariant broken: " + checks->violation()->what);
  return static_cast<double>(carried(ring) - before) / seconds;
}

}  // namespace limb_ring::hops
