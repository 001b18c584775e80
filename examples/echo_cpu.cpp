// The smallest useful CPU of a node: sends every packet back to where it came from, and tells of
// interrupts. Start it as a node's `cpu: command`, or beside a node with `cpu: attached`:
//   echo_cpu [RING NODE]      (otherwise LIMB_RING_RING and LIMB_RING_NODE, as ringd sets them)
#include <limb_ring/host_port.h>

#include <cstdio>

namespace {

using namespace limb_ring;

bool handle(HostPort& port, const Message& message) {
  if (const auto* packet = std::get_if<Packet>(&message)) {
    port.send(packet->source, packet->data, packet->priority, packet->channel);
  } else if (const auto* interrupt = std::get_if<Interrupt>(&message)) {
    std::printf("INT%d from node %d\n", interrupt->factor, interrupt->source);
  } else if (const auto* result = std::get_if<Result>(&message)) {
    if (result->outcome != Outcome::delivered) std::printf("echo: %s\n", to_string(result->outcome));
  } else if (const auto* end = std::get_if<Disconnected>(&message)) {
    std::printf("the ring is gone: %s\n", end->reason.c_str());
    return false;
  }
  std::fflush(stdout);
  return true;
}

}  // namespace

int main(int argc, char** argv) try {
  ConnectOptions options;
  options.role = Role::cpu;
  options.alive_period = std::chrono::milliseconds{500};
  if (argc > 1) options.ring = argv[1];
  if (argc > 2) options.node = argv[2];
  HostPort port = HostPort::connect(options);
  std::printf("CPU of node %d (%s) of ring %s\n", port.id(), port.name().c_str(), port.ring().c_str());
  for (bool on = true; on;) {
    const auto message = port.receive(std::chrono::milliseconds{100});
    if (message) on = handle(port, *message);
  }
} catch (const HostPortError& problem) {
  std::fprintf(stderr, "echo_cpu: %s\n", problem.what());
  return 1;
}
