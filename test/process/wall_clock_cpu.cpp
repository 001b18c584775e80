// A CPU that must not be: it sends what the machine's clock says, so no two runs are alike.
#include <limb_ring/host_port.h>

#include <chrono>
#include <cstring>

int main() try {
  limb_ring::ConnectOptions options;
  options.role = limb_ring::Role::cpu;
  limb_ring::HostPort port = limb_ring::HostPort::connect(options);
  for (auto next = port.now(); port.connected(); port.sleep_until(next += std::chrono::milliseconds(100))) {
    const auto now = std::chrono::system_clock::now().time_since_epoch().count();
    std::vector<std::uint8_t> data(sizeof now);
    std::memcpy(data.data(), &now, sizeof now);
    port.send(0, data);
  }
} catch (const limb_ring::HostPortError&) {
  return 1;
}
