// Packet-hops per second of the real core under the virtual clock, with and without the invariants,
// beside a bare event loop and, where it is installed, ns-3.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <queue>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "hops_report.h"
#include "load.h"
#include "sim/invariants.h"
#include "sim/virtual_ring.h"
#include "tools/common/command_line.h"
#include "wire/checksum.h"
#include "wire/packet.h"

namespace limb_ring::hops {
namespace {

using Time = std::chrono::nanoseconds;
using Bytes = std::vector<std::uint8_t>;

struct Hop {
  Time at;
  std::uint64_t order;
  unsigned node;
  bool operator>(const Hop& other) const { return at != other.at ? at > other.at : order > other.order; }
};

class BareRing {
 public:
  explicit BareRing(unsigned nodes)
      : lines_(nodes, Bytes(wire::kMaxDataPacketSize, 0x5A)), buffers_(lines_), free_at_(nodes), order_(nodes) {
    for (unsigned node = 0; node < nodes; ++node) events_.push({Time{0}, node, node});
  }

  /// A packet takes its place behind what is on the line, as in a saturated ring.
  void hop() {
    const Hop hop = events_.top();
    events_.pop();
    const unsigned next = (hop.node + 1) % static_cast<unsigned>(lines_.size());
    carry(hop.node, next);
    const Time start = std::max(hop.at, free_at_[hop.node]);
    free_at_[hop.node] = start + kPacket;
    events_.push({start + kDelay, order_++, next});
  }
  std::uint32_t crcs() const { return crcs_; }

 private:
  void carry(unsigned node, unsigned next) {
    Bytes& buffer = buffers_[node];
    std::memcpy(buffer.data(), lines_[node].data(), buffer.size());
    crcs_ ^= wire::crc32({buffer.data(), buffer.size() - wire::kCrcSize});
    std::memcpy(lines_[next].data(), buffer.data(), buffer.size());
  }

  std::vector<Bytes> lines_, buffers_;
  std::vector<Time> free_at_;
  std::priority_queue<Hop, std::vector<Hop>, std::greater<Hop>> events_;
  std::uint64_t order_;
  std::uint32_t crcs_ = 0;
};

/// The same ring with no protocol: a heap of events, one per hop, each with the two copies of the
/// packet and the CRC check that no relay can do without.
/// @return packet-hops per second of wall-clock time
double bare_loop(unsigned nodes, std::uint64_t hops) {
  BareRing ring(nodes);
  const Stopwatch watch;
  for (std::uint64_t i = 0; i < hops; ++i) ring.hop();
  const double seconds = watch.seconds();
  volatile std::uint32_t kept = ring.crcs();  // or the compiler would leave the CRCs out
  static_cast<void>(kept);
  return static_cast<double>(hops) / seconds;
}

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
/// CPUs do: if all begin in one instant they stay in step, and the clock has a tenth of the instants to visit.
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

/// The real core under the virtual clock, once it has joined, with all invariants checked or none.
/// @return packet-hops per second of wall-clock time, over at least `hops`
/// @throw std::runtime_error if an invariant was broken, or a packet not delivered
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
  if (checks && checks->violation()) throw std::runtime_error("invariant broken: " + checks->violation()->what());
  return static_cast<double>(carried(ring) - before) / seconds;
}

namespace fs = std::filesystem;

fs::path program() { return fs::read_symlink("/proc/self/exe").replace_filename("bench_ns3_ring"); }

/// What a shell reads as one word.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

/// Whether bench_ns3_ring lies beside this program; it is built where ns-3 is installed.
bool ns3_installed() { return fs::exists(program()); }

/// One run of it.
/// @return packet-hops per second of wall-clock time, without the start of the program
/// @throw std::runtime_error if it fails
double ns3_ring(unsigned nodes, std::uint64_t hops) {
  const std::string command = quoted(program()) + " " + std::to_string(nodes) + " " + std::to_string(hops);
  const std::unique_ptr<FILE, int (*)(FILE*)> output(popen(command.c_str(), "r"), pclose);
  double rate = 0;
  if (!output || std::fscanf(output.get(), "%lf", &rate) != 1) throw std::runtime_error("failed: " + command);
  return rate;
}

constexpr const char* kBareLoop =
    "bare loop: per hop a heap event, two copies and a CRC check; no slices, queues, returns, time-outs or results";

struct Options {
  std::uint64_t hops = 300'000;
  unsigned rounds = 9;
  bool json = false;
};

struct Contender {
  std::string name;
  std::function<double(unsigned nodes, std::uint64_t hops)> rate;
};

std::vector<Contender> contenders() {
  std::vector<Contender> all{
      {"bare loop", bare_loop},
      {"core", [](unsigned nodes, std::uint64_t hops) { return core_ring(nodes, hops, false); }},
      {"core, all invariants", [](unsigned nodes, std::uint64_t hops) { return core_ring(nodes, hops, true); }},
      {"ns-3", nullptr}};
  if (ns3_installed()) all.back().rate = ns3_ring;
  return all;
}

/// In turns, so that what disturbs the machine disturbs all alike.
std::vector<Series> measure(const Options& options) {
  const std::vector<Contender> all = contenders();
  std::vector<Series> series;
  for (const Contender& contender : all) series.push_back({contender.name, {}});
  for (unsigned round = 0; round < options.rounds; ++round)
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t size = 0; size < kSizes.size(); ++size)
        if (all[i].rate) series[i].rates[size].push_back(all[i].rate(kSizes[size], options.hops));
  return series;
}

void print_notes(const Options& options) {
  std::cout << "\nm_hops_s_N: with N nodes, millions of packet-hops per second of wall-clock time, best of "
            << options.rounds
            << " rounds;\n"
               "cost_N: of a hop, beside the bare loop's; growth: of a hop's cost from "
            << kSizes.front() << " to " << kSizes.back() << " nodes; medians\n"
            << "core: its nodes begin at random within a lap (seed " << kSeed << "), and are measured after "
            << kLapsBefore << " laps\n\n"
            << kBareLoop << '\n'
            << "ns-3: "
            << (ns3_installed() ? "devices that store and forward; per hop one copy, no CRC check; no IP stack\n"
                                : "not installed (libns3-dev)\n")
            << "goals: the core 0.8 times the bare loop, 6 with all invariants, growth of the core at most 1.1\n";
}

void print(const Options& options) {
  const std::vector<app::Row> rows = report(measure(options));
  std::cout << app::format_rows(rows, options.json ? app::Format::json : app::Format::text);
  if (!options.json) print_notes(options);
}

}  // namespace
}  // namespace limb_ring::hops

int main(int argc, char** argv) {
  using namespace limb_ring;
  hops::Options options;
  CLI::App app(
      "Rings of 16 and 254 nodes that always have 512 bytes to send, at 1 Gbit/s and d = 512 ns:\n"
      "the core under the virtual clock beside a bare event loop and ns-3.",
      "bench_sim_hops");
  app.add_option("--hops", options.hops, "Packet-hops per measurement, 1000 to 1000000000")
      ->transform(cli::whole(1000, 1'000'000'000))
      ->capture_default_str();
  app.add_option("--rounds", options.rounds, "Rounds in which all take their turn, 1 to 1000")
      ->transform(cli::whole(1, 1000))
      ->capture_default_str();
  app.add_flag("--json", options.json, "Print JSON, for programs");
  if (const auto end = cli::parse(app, argc, argv)) return *end;
  try {
    hops::print(options);
  } catch (const std::exception& problem) {
    std::cerr << "bench_sim_hops: " << problem.what() << '\n';
    return 1;
  }
  return 0;
}
