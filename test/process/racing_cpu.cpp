// A CPU with a race, beside another one: `write FILE` writes the file at 2 s, `read FILE` reads it in the same
// instant, sends what it has read, and fails where that is nothing.
#include <limb_ring/host_port.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

int main(int, char** arguments) try {
  using namespace std::chrono_literals;
  const bool writes = arguments[1] == std::string("write");
  const std::string file = arguments[2];
  if (writes) std::filesystem::remove(file);
  limb_ring::ConnectOptions options;
  options.role = limb_ring::Role::cpu;
  limb_ring::HostPort port = limb_ring::HostPort::connect(options);
  port.sleep_until(2s);
  if (writes) std::ofstream(file) << "ready";
  if (!writes) {
    std::ifstream in(file);
    const std::vector<std::uint8_t> read{std::istreambuf_iterator<char>(in), {}};
    if (read.empty()) return 1;
    port.send(0, read);
  }
  while (port.connected()) port.receive(1s);
} catch (const limb_ring::HostPortError&) {
  return 0;  // the ring has ended
}
