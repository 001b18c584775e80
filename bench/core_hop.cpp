// What one hop costs in the core: DATPs of 524 bytes that pass 16 nodes on lines without a data rate, beside the memcpy
// and CRC no hop can do without, and with a flight recorder at each node.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "core/network_controller.h"
#include "judge/flight_recorder.h"
#include "support/packets.h"

namespace {

using namespace limb_ring;
using core::Line;
using Clock = std::chrono::steady_clock;
using Packets = std::vector<std::vector<std::uint8_t>>;

constexpr unsigned kNodes = 16;
constexpr unsigned kPackets = 10;  ///< that one read brings, where all nodes send
constexpr unsigned kBatches = 100000;
constexpr unsigned kRounds = 7;
constexpr std::size_t kRecorder = 8u << 20;  ///< bytes, as recorder.size has it

Packets make_packets() {
  Packets packets;
  const std::vector<std::uint8_t> data(wire::kMaxPayload, 0x5A);
  for (unsigned i = 0; i < kPackets; ++i) {
    test::DataPacket packet;
    packet.code.sequence = wire::Sequence{static_cast<std::uint8_t>(i & 7)};
    packet.source = wire::NodeId{200};
    packet.destination = wire::NodeId{201};
    packet.data = {data.data(), data.size()};
    packets.push_back(encoded(packet));
  }
  return packets;
}

/// Best of some rounds, in ns per packet.
template <class Batch>
double measure(Batch batch) {
  double best = 1e9;
  for (unsigned round = 0; round < kRounds; ++round) {
    const auto start = Clock::now();
    for (unsigned i = 0; i < kBatches; ++i) batch(i);
    const std::chrono::duration<double, std::nano> taken = Clock::now() - start;
    best = std::min(best, taken.count() / (kBatches * kPackets));
  }
  return best;
}

core::Settings settings_of(unsigned node) {
  core::Settings settings;
  settings.id = wire::NodeId{static_cast<std::uint8_t>(node)};
  settings.order = {wire::NodeId{200}, wire::NodeId{201}};
  for (unsigned id = 0; id < kNodes; ++id) settings.order.push_back(wire::NodeId{static_cast<std::uint8_t>(id)});
  return settings;
}

/// A node that passes packets on, recorded or not.
class Node {
 public:
  Node(unsigned id, bool recorded) : core_(settings_of(id), core::Time{}) {
    if (recorded) record();
    core_.apply(core::input::InputUp{Line::first, wire::NodeId{200}}, core::Time{});
    core_.apply(core::input::OutputUp{Line::first, wire::NodeId{201}}, core::Time{});
  }
  void pass(const Packets& packets, core::Time now) {
    for (const auto& packet : packets)
      core_.receive(Line::first, {wire::SliceKind::whole, {packet.data(), packet.size()}}, now);
    core_.apply(core::input::Run{}, now);
    core_.output(Line::first).clear();
  }

 private:
  void record() {
    memory_.resize(kRecorder / sizeof memory_[0]);
    recorder::Title title;
    title.settings = core_.settings();
    recorder_ = std::make_unique<recorder::FlightRecorder>(core_, reinterpret_cast<std::uint8_t*>(memory_.data()),
                                                           kRecorder, title, core::Time{}, [] {});
  }

  core::NetworkController core_;
  std::vector<std::uint64_t> memory_;
  std::unique_ptr<recorder::FlightRecorder> recorder_;
};

double hop(const Packets& packets, bool recorded) {
  std::vector<std::unique_ptr<Node>> nodes;
  for (unsigned id = 0; id < kNodes; ++id) nodes.push_back(std::make_unique<Node>(id, recorded));
  core::Time now{};
  return measure([&](unsigned i) {
    now += std::chrono::microseconds(1);
    nodes[i % kNodes]->pass(packets, now);
  });
}

double reference(const Packets& packets) {
  std::vector<std::uint8_t> out(kPackets * wire::kMaxSliceSize);
  std::uint32_t crcs = 0;
  const double taken = measure([&](unsigned) {
    std::uint8_t* place = out.data();
    for (const auto& packet : packets) {
      crcs ^= wire::crc32({packet.data(), packet.size() - wire::kCrcSize});
      std::memcpy(place, packet.data(), packet.size());
      place += packet.size();
    }
  });
  if (crcs == 1) std::puts("");  // keeps the work
  return taken;
}

}  // namespace

int main() {
  const auto packets = make_packets();
  const double bare = reference(packets);
  const double core = hop(packets, false);
  const double recorded = hop(packets, true);
  std::printf("memcpy and CRC       %6.1f ns per packet of 524 bytes\n", bare);
  std::printf("core, one hop        %6.1f ns  (%.2fx)\n", core, core / bare);
  std::printf("with flight recorder %6.1f ns  (%.1f ns more)\n", recorded, recorded - core);
  return 0;
}
