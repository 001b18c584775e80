// A CPU that talks to all others: a packet each millisecond to one after the other, and an answer to each it hears.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>

#include "limb_ring/host_port.h"

namespace {

using namespace limb_ring;
using namespace std::chrono_literals;

constexpr unsigned kNodes = 16;
constexpr std::uint8_t kQuestion = 0, kAnswer = 1;  // channels

}  // namespace

int main() try {
  ConnectOptions options;
  options.role = Role::cpu;
  HostPort port = HostPort::connect(options);
  unsigned asked = port.id();
  auto due = port.now();
  while (port.connected()) {
    const auto message = port.receive(std::max<std::chrono::nanoseconds>(due - port.now(), 0ns));
    const auto* packet = message ? std::get_if<Packet>(&*message) : nullptr;
    if (packet != nullptr && packet->channel == kQuestion) port.send(packet->source, packet->data, 1, kAnswer);
    if (port.now() < due) continue;
    due += 1ms;
    asked = (asked + 1) % kNodes;
    if (asked != port.id()) port.send(asked, std::vector<std::uint8_t>(20 * (asked + 1), port.id()), 0, kQuestion);
  }
} catch (const limb_ring::HostPortError&) {
  return 0;  // the ring has ended
}
