// Packet-hops per second under the virtual clock: rings of nodes that always have something to send
// (512 bytes, 1 Gbit/s, d = 512 ns), beside a bare event loop that does the same ring with no
// protocol: a heap of events, one per hop, each with the two copies and the CRC check that no relay
// can do without.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <queue>
#include <vector>

#include "sim/invariants.h"
#include "sim/virtual_ring.h"

namespace {

using namespace limb_ring;
using namespace std::chrono_literals;
using core::Duration;
using core::Time;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kPayload = 512;
const Duration kByte = 8ns;
const Duration kDelay = 512ns;
const Duration kPacket = kByte * static_cast<int>(kPayload + wire::kOverhead);
constexpr double kHops = 1e6;  ///< per measurement
constexpr int kRounds = 3;

/// @return packet-hops per second of wall-clock time
template <class Run>
double rate(Run run) {
  double best = 0;
  for (int round = 0; round < kRounds; ++round) {
    const auto start = Clock::now();
    const double hops = run();
    best = std::max(best, hops / std::chrono::duration<double>(Clock::now() - start).count());
  }
  return best;
}

/// Every packet takes its place behind what is on the line, as in a saturated ring.
double bare(unsigned nodes) {
  struct Hop {
    Time at;
    std::uint64_t order;
    unsigned node, packet;
    bool operator>(const Hop& other) const { return at != other.at ? at > other.at : order > other.order; }
  };
  std::vector<std::vector<std::uint8_t>> lines(nodes), buffers(nodes);
  std::vector<Time> free_at(nodes);
  std::priority_queue<Hop, std::vector<Hop>, std::greater<Hop>> events;
  std::vector<std::uint8_t> packet(kPayload + wire::kOverhead, 0x5A);
  for (unsigned i = 0; i < nodes; ++i) {
    lines[i] = buffers[i] = packet;
    events.push({Time{}, i, i, i});
  }
  std::uint64_t order = nodes;
  std::uint32_t crcs = 0;
  double hops = 0;
  for (; hops < kHops; ++hops) {
    const Hop hop = events.top();
    events.pop();
    const unsigned next = (hop.node + 1) % nodes;
    std::memcpy(buffers[hop.node].data(), lines[hop.node].data(), packet.size());
    crcs ^= wire::crc32({buffers[hop.node].data(), packet.size() - wire::kCrcSize});
    std::memcpy(lines[next].data(), buffers[hop.node].data(), packet.size());
    const Time start = std::max(hop.at, free_at[hop.node]);
    free_at[hop.node] = start + kPacket;
    events.push({start + kDelay, order++, next, hop.packet});
  }
  if (crcs == 1) std::puts("");  // keeps the work
  return hops;
}

double relayed(sim::VirtualRing& ring, unsigned nodes) {
  double hops = 0;
  for (unsigned id = 0; id < nodes; ++id) {
    const core::Counters& counters = ring.counters(static_cast<wire::NodeId>(id));
    hops += static_cast<double>(counters.relayed_data + counters.sent_data);
  }
  return hops;
}

double with_core(unsigned nodes, bool invariants) {
  sim::VirtualRingOptions options;
  options.nodes = nodes;
  options.byte_time = kByte;
  options.relay_delay = kDelay;
  options.keep_logs = false;
  options.adjust = [](core::Settings& settings) { settings.send_timeout_least = Duration{0}; };
  sim::VirtualRing ring(options);
  std::unique_ptr<sim::Invariants> watch;
  if (invariants) watch = std::make_unique<sim::Invariants>(ring);
  ring.join();
  const std::vector<std::uint8_t> data(kPayload, 0x5A);
  const auto send = [&](wire::NodeId id) { ring.send(id, static_cast<wire::NodeId>((id + nodes / 2) % nodes), data); };
  ring.on_event = [&](wire::NodeId id, const core::Event& event) {
    if (std::holds_alternative<core::SendEnded>(event.what)) send(id);
  };
  for (unsigned id = 0; id < nodes; ++id) send(static_cast<wire::NodeId>(id));
  const double before = relayed(ring, nodes);
  while (relayed(ring, nodes) - before < kHops) ring.run_for(kPacket * static_cast<int>(nodes) * 10);
  return relayed(ring, nodes) - before;
}

}  // namespace

int main() {
  std::printf("packet-hops per second, millions (best of %d)\n\n%28s %8s %8s\n", kRounds, "nodes", "16", "254");
  double rates[3][2];
  const unsigned sizes[2] = {16, 254};
  for (int i = 0; i < 2; ++i) {
    rates[0][i] = rate([&] { return bare(sizes[i]); }) / 1e6;
    rates[1][i] = rate([&] { return with_core(sizes[i], false); }) / 1e6;
    rates[2][i] = rate([&] { return with_core(sizes[i], true); }) / 1e6;
  }
  const char* names[3] = {"bare event loop", "the core", "the core, all invariants"};
  for (int row = 0; row < 3; ++row)
    std::printf("%28s %8.2f %8.2f   %.2fx, %.2fx the bare loop's time\n", names[row], rates[row][0], rates[row][1],
                rates[0][0] / rates[row][0], rates[0][1] / rates[row][1]);
  return 0;
}
