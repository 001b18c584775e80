// A CPU that lets no time pass at first: it asks for the time again and again, until 100 ms of it are over.
#include <limb_ring/host_port.h>

using namespace std::chrono_literals;

int main() try {
  limb_ring::ConnectOptions options;
  options.role = limb_ring::Role::cpu;
  limb_ring::HostPort port = limb_ring::HostPort::connect(options);
  for (const auto end = port.now() + 100ms; port.now() < end;) port.ask(R"({"do": "clock"})", 1s);
  while (port.connected()) port.sleep_until(port.now() + 10ms);
} catch (const limb_ring::HostPortError&) {
  return 1;
}
