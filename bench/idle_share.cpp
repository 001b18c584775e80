#include "bench/idle_share.h"

#include <chrono>
#include <optional>
#include <thread>

#include "bench/cpu_share.h"
#include "bench/waits.h"

namespace limb_ring::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kSettling{500};

std::optional<HostPort> reading_cpu(const PrivateRing& ring) {
  if (ring.config().nodes[0].cpu.kind != config::CpuConfig::Kind::attached) return {};
  return ring.connect(0, Role::cpu);
}

void let_pass(const Setup& setup, std::optional<HostPort>& cpu, steady_clock::duration time) {
  const auto end = steady_clock::now() + time;
  while (steady_clock::now() < end) {
    setup.poll();
    if (cpu)
      cpu->receive(kSlice);
    else
      std::this_thread::sleep_for(kSlice);
  }
}

}  // namespace

double measure_idle_percent(const Setup& setup, PrivateRing& ring) {
  std::optional<HostPort> cpu = reading_cpu(ring);
  let_pass(setup, cpu, kSettling);
  const CpuShare share(ring.processes());
  let_pass(setup, cpu,
           std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(setup.seconds)));
  return share.percent();
}

}  // namespace limb_ring::bench
