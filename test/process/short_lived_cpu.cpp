// A CPU that ends badly after half a second of the ring's time. With an argument it sends before, and says which of its
// ends is seen first: process, or connection.
#include <limb_ring/host_port.h>
#include <unistd.h>

#include <optional>
#include <string>
#include <thread>
#include <vector>

using namespace std::chrono_literals;

int main(int argc, char** argv) try {
  const std::string first = argc > 1 ? argv[1] : "";
  limb_ring::ConnectOptions options;
  options.role = limb_ring::Role::cpu;
  std::optional<limb_ring::HostPort> port(limb_ring::HostPort::connect(options));
  port->sleep_until(port->now() + 500ms);
  const std::vector<std::uint8_t> data(400);
  for (int i = 0; i < 5 && !first.empty(); ++i) port->send(0, data.data(), data.size());
  if (first == "process" && ::fork() == 0) return ::pause();  // keeps the connection until its group is killed
  if (first == "connection") {
    port.reset();
    std::this_thread::sleep_for(100ms);
    return 3;
  }
  return port->connected() ? 3 : 0;
} catch (const limb_ring::HostPortError&) {
  return 1;
}
