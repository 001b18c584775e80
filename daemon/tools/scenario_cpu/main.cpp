// scenario_cpu: the CPU of a node in a scenario on live daemons, started by ringd. It takes packets and counts them.
// It sends nothing: the scenario sends in its place.
#include <limb_ring/host_port.h>
#include <limb_ring/payload/packet_type.h>

#include <cstdio>
#include <cstring>
#include <exception>

#include "tools/scenario_cpu/taken_board.h"

namespace {

constexpr std::chrono::milliseconds kTick{50};

void take_all(limb_ring::HostPort& port, limb_ring::scenario_cpu::TakenBoard& board) {
  while (port.connected()) {
    const auto message = port.receive(kTick);
    const auto* packet = message ? std::get_if<limb_ring::Packet>(&*message) : nullptr;
    if (packet && packet->channel == limb_ring::payload::kUserChannel) board.count(packet->data[0]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) {
    const bool help = std::strcmp(argv[1], "--help") == 0 || std::strcmp(argv[1], "-h") == 0;
    std::fprintf(
        help ? stdout : stderr,
        "scenario_cpu: the CPU of a node in a scenario: takes packets, and counts them where the scenario sees it.\n"
        "'ringctl scenario run' has ringd start it: with --live at every node, with --virtual at those whose CPU is\n"
        "no program of the ring's file, or with --scenario-cpus at every node. No options.\n");
    return help ? 0 : 2;
  }
  try {
    limb_ring::ConnectOptions options;  // ring and node: the environment's, as ringd sets it
    options.role = limb_ring::Role::cpu;
    options.alive_period = 4 * kTick;
    auto port = limb_ring::HostPort::connect(options);
    limb_ring::scenario_cpu::TakenBoard board(port.ring(), port.id());
    take_all(port, board);
    return 0;
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "scenario_cpu: %s\n", problem.what());
    return 1;
  }
}
