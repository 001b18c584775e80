// What one hop costs in the core: DATPs of 524 bytes through Blocks::receive on a line without
// a data rate, beside the memcpy and CRC no hop can do without.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <vector>

#include "core/blocks.h"

namespace {

using namespace limb_ring;
using Clock = std::chrono::steady_clock;

constexpr unsigned kPackets = 64;  ///< per batch: as much as one read brings
constexpr unsigned kBatches = 20000;
constexpr unsigned kRounds = 7;

std::vector<std::vector<std::uint8_t>> make_packets() {
  std::vector<std::vector<std::uint8_t>> packets;
  const std::vector<std::uint8_t> data(wire::kMaxPayload, 0x5A);
  for (unsigned i = 0; i < kPackets; ++i) {
    packets.emplace_back(wire::kMaxDataPacketSize);
    const wire::Code code{false, 0, wire::Sequence{static_cast<std::uint8_t>(i & 7)}};
    wire::encode({code, 3, wire::NodeId{0}, wire::kFbcUntaken, wire::NodeId{9}, 0, {data.data(), data.size()}},
                 packets.back().data());
  }
  return packets;
}

/// Best of some rounds, in ns per packet.
template <class Batch>
double measure(Batch batch) {
  double best = 1e9;
  for (unsigned round = 0; round < kRounds; ++round) {
    const auto start = Clock::now();
    for (unsigned i = 0; i < kBatches; ++i) batch();
    const std::chrono::duration<double, std::nano> taken = Clock::now() - start;
    best = std::min(best, taken.count() / (kBatches * kPackets));
  }
  return best;
}

double hop(const std::vector<std::vector<std::uint8_t>>& packets) {
  core::Settings settings;
  settings.id = wire::NodeId{5};
  settings.order.clear();
  for (unsigned id = 0; id < 16; ++id) settings.order.push_back(static_cast<wire::NodeId>(id));
  core::Blocks node(settings);
  node.input_up(wire::NodeId{4}, core::Time{});
  node.output_up(wire::NodeId{6}, core::Time{});
  core::Time now{};
  return measure([&] {
    now += core::Duration{1000};
    for (const auto& packet : packets) node.receive({wire::SliceKind::whole, {packet.data(), packet.size()}}, now);
    node.run(now);
    node.line().clear();
  });
}

double reference(const std::vector<std::vector<std::uint8_t>>& packets) {
  std::vector<std::uint8_t> out(kPackets * wire::kMaxSliceSize);
  std::uint32_t crcs = 0;
  const double taken = measure([&] {
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
  const double core = hop(packets);
  std::printf("memcpy and CRC   %6.1f ns per packet of 524 bytes\n", bare);
  std::printf("core, one hop    %6.1f ns  (%.2fx)\n", core, core / bare);
  return 0;
}
