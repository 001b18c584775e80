// echo_cpu.cpp: sends every packet back to where it came from, and tells of interrupts
//   echo_cpu [RING NODE]     as a node's `cpu: {command: [/PATH/echo_cpu]}` without: ringd tells it. What roslaunch
//                            adds behind them plays no part
#include <limb_ring/host_port.h>

#include <iostream>

using namespace limb_ring;

int main(int argc, char** argv) try {
  if (argc == 2) {
    std::cerr << "usage: echo_cpu [RING NODE]" << std::endl;
    return 2;
  }
  ConnectOptions options;
  options.role = Role::cpu;
  options.alive_period = std::chrono::milliseconds(500);  // a promise: at least so often it calls receive() or send()
  if (argc > 2) options.ring = argv[1], options.node = argv[2];
  HostPort port = HostPort::connect(options);
  std::cout << "CPU of node " << int(port.id()) << " (" << port.name() << ") of ring " << port.ring() << std::endl;
  while (port.connected()) {
    const auto message = port.receive(std::chrono::milliseconds(100));
    if (!message) continue;  // a quiet 100 ms
    if (const auto* packet = std::get_if<Packet>(&*message)) {
      std::cout << packet->data.size() << " bytes from node " << int(packet->source) << std::endl;
      port.send(packet->source, packet->data, packet->priority, packet->channel);
    } else if (const auto* result = std::get_if<Result>(&*message)) {
      std::cout << "sent back: " << to_string(result->outcome) << std::endl;
    } else if (const auto* interrupt = std::get_if<Interrupt>(&*message)) {
      std::cout << "INT" << int(interrupt->factor) << " from node " << int(interrupt->source) << std::endl;
    } else if (const auto* end = std::get_if<Disconnected>(&*message)) {
      std::cout << "the ring is gone: " << end->reason << std::endl;
    }
  }
} catch (const HostPortError& problem) {
  std::cerr << "echo_cpu: " << problem.what() << std::endl;
  return 1;
}
