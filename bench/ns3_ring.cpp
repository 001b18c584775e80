// The same ring in ns-3 (https://www.nsnam.org), beside which the core's packet-hops per second are
// shown: point-to-point devices and channels joined to a ring, no IP stack; a receive callback
// sends what is not its own node's on. ns-3's devices store and forward, copy a packet's bytes
// once a hop (writing the framing into bytes another reference shares), and check no CRC.
#include <ns3/callback.h>
#include <ns3/data-rate.h>
#include <ns3/drop-tail-queue.h>
#include <ns3/mac48-address.h>
#include <ns3/node.h>
#include <ns3/nstime.h>
#include <ns3/packet.h>
#include <ns3/point-to-point-channel.h>
#include <ns3/point-to-point-net-device.h>
#include <ns3/simulator.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "load.h"

namespace {

using namespace limb_ring;
using ns3::Ptr;
using Device = ns3::PointToPointNetDevice;

constexpr int kRounds = 3;
constexpr std::uint64_t kHops = 500'000;     // in each
constexpr std::uint16_t kProtocol = 0x0800;  // its PPP framing knows IPv4 and IPv6 alone
constexpr std::size_t kPppSize = 2;          // bytes it adds; the packet leaves room for them

Ptr<Device> add_device(Ptr<ns3::Node> node, Ptr<ns3::PointToPointChannel> line) {
  auto device = ns3::CreateObject<Device>();
  device->SetAddress(ns3::Mac48Address::Allocate());
  device->SetDataRate(ns3::DataRate(8'000'000'000 / hops::kByte.count()));
  device->SetQueue(ns3::CreateObject<ns3::DropTailQueue<ns3::Packet>>());
  node->AddDevice(device);
  device->Attach(line);
  return device;
}

/// Counts the hops of all, and ends the simulation with the last of them.
class Hops {
 public:
  explicit Hops(std::uint64_t wanted) : left_(wanted) {}
  void count() {
    if (--left_ == 0) ns3::Simulator::Stop();
  }

 private:
  std::uint64_t left_;
};

/// One node's relay: its own packet has come home and the next follows, any other goes on.
class Relay {
 public:
  Relay(std::uint8_t id, Ptr<Device> output, Hops& hops) : id_(id), output_(output), hops_(hops) {}

  bool take(Ptr<ns3::NetDevice>, Ptr<const ns3::Packet> packet, std::uint16_t, const ns3::Address&) {
    hops_.count();
    std::uint8_t source = 0;
    packet->CopyData(&source, sizeof source);
    if (source == id_)
      send_own();
    else
      put(packet->Copy());
    return true;
  }

  void send_own() {
    std::array<std::uint8_t, wire::kMaxDataPacketSize - kPppSize> bytes{id_};
    put(ns3::Create<ns3::Packet>(bytes.data(), bytes.size()));
  }

 private:
  void put(Ptr<ns3::Packet> packet) {
    if (output_->Send(packet, output_->GetBroadcast(), kProtocol)) return;
    std::fputs("bench_ns3_ring: a queue was full\n", stderr);
    std::exit(1);
  }

  std::uint8_t id_;
  Ptr<Device> output_;
  Hops& hops_;
};

class Ring {
 public:
  Ring(unsigned nodes, std::uint64_t hops) : hops_(hops) {
    std::vector<Line> lines;
    for (unsigned id = 0; id < nodes; ++id) nodes_.push_back(ns3::CreateObject<ns3::Node>());
    for (unsigned id = 0; id < nodes; ++id) lines.push_back(line_out_of(id));
    for (unsigned id = 0; id < nodes; ++id)
      relays_.push_back(std::make_unique<Relay>(static_cast<std::uint8_t>(id), lines[id].output, hops_));
    for (unsigned id = 0; id < nodes; ++id)
      lines[id].input->SetReceiveCallback(ns3::MakeCallback(&Relay::take, relays_[(id + 1) % nodes].get()));
  }
  ~Ring() { ns3::Simulator::Destroy(); }
  Ring(const Ring&) = delete;

  void run() {
    for (const auto& relay : relays_) relay->send_own();
    ns3::Simulator::Run();
  }

 private:
  struct Line {
    Ptr<Device> output, input;
  };

  Line line_out_of(unsigned id) const {
    auto line = ns3::CreateObject<ns3::PointToPointChannel>();
    line->SetAttribute("Delay", ns3::TimeValue(ns3::NanoSeconds(hops::kDelay.count())));
    const Ptr<Device> output = add_device(nodes_[id], line);
    return {output, add_device(nodes_[(id + 1) % nodes_.size()], line)};
  }

  Hops hops_;
  std::vector<Ptr<ns3::Node>> nodes_;
  std::vector<std::unique_ptr<Relay>> relays_;
};

/// @return packet-hops per second of wall-clock time
double rate(unsigned nodes, std::uint64_t hops) {
  Ring ring(nodes, hops);
  const hops::Stopwatch watch;
  ring.run();
  return static_cast<double>(hops) / watch.seconds();
}

void print_best(unsigned nodes) {
  double best = 0;
  for (int round = 0; round < kRounds; ++round) best = std::max(best, rate(nodes, kHops));
  std::printf("ns-3, %3u nodes: %.2f million packet-hops per second\n", nodes, best / 1e6);
}

int usage() {
  std::fprintf(stderr,
               "usage: bench_ns3_ring [NODES HOPS]\n"
               "Packet-hops per second of a ring in ns-3: one run of 2 to 255 NODES over so many HOPS,\n"
               "or the best of %d runs of each size that bench_sim_hops measures.\n",
               kRounds);
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 1) {
    for (const unsigned nodes : hops::kSizes) print_best(nodes);
    return 0;
  }
  if (argc != 3) return usage();
  const long nodes = std::atol(argv[1]), hops = std::atol(argv[2]);
  if (nodes < 2 || nodes > 255 || hops < 1) return usage();
  std::printf("%.0f\n", rate(static_cast<unsigned>(nodes), static_cast<std::uint64_t>(hops)));
  return 0;
}
