// A CPU that ends or loops when it was told to: planned_cpu FILE WHAT MS. Until then it sends every 10 ms of the ring's
// clock, and writes that time, in us, into FILE. In real time it takes as long as it likes.
#include <limb_ring/host_port.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <random>
#include <string>

namespace {

using namespace std::chrono_literals;

void take_some_time() { ::usleep(std::random_device{}() % 2000); }

void end_as(const std::string& what) {
  if (what == "crashes") std::abort();
  if (what == "exits") std::exit(3);
  volatile bool forever = what == "loops";
  while (forever) {
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 4) return 2;
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const std::string what = argv[2];
  take_some_time();
  if (what == "does_not_boot") return 3;
  limb_ring::ConnectOptions options;
  options.role = limb_ring::Role::cpu;
  options.alive_period = 50ms;
  limb_ring::HostPort port = limb_ring::HostPort::connect(options);
  const std::chrono::nanoseconds end = std::stoi(argv[3]) * 1ms;
  std::ofstream beats(argv[1], std::ios::app);
  while (port.connected()) {
    beats << port.now() / 1us << std::endl;
    port.send(0, {1});
    if (port.now() >= end) {
      port.send(0, {2});
      take_some_time();
      end_as(what);
    }
    port.sleep_until(port.now() + 10ms);
  }
} catch (const limb_ring::HostPortError&) {
  return 0;  // the ring has ended
}
