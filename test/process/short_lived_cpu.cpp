// A CPU that ends badly after half a second of the ring's time.
#include <limb_ring/host_port.h>

int main() try {
  limb_ring::ConnectOptions options;
  options.role = limb_ring::Role::cpu;
  limb_ring::HostPort port = limb_ring::HostPort::connect(options);
  port.sleep_until(port.now() + std::chrono::milliseconds(500));
  return port.connected() ? 3 : 0;
} catch (const limb_ring::HostPortError&) {
  return 1;
}
