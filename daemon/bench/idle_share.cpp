#include "bench/idle_share.h"

#include <time.h>

#include <chrono>
#include <optional>
#include <stdexcept>
#include <thread>

#include "bench/waits.h"

namespace limb_ring::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kSettling{500};

double cpu_seconds(pid_t process) {
  clockid_t clock{};
  timespec used{};
  if (::clock_getcpuclockid(process, &clock) != 0 || ::clock_gettime(clock, &used) != 0)
    throw std::runtime_error("process " + std::to_string(process) + " of an idle ring has ended");
  return static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9;
}

double cpu_seconds(const std::vector<pid_t>& processes) {
  double sum = 0;
  for (const pid_t process : processes) sum += cpu_seconds(process);
  return sum;
}

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
  const std::vector<pid_t> processes = ring.processes();
  const double before = cpu_seconds(processes);
  const auto begun = steady_clock::now();
  let_pass(setup, cpu,
           std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(setup.seconds)));
  const double used = cpu_seconds(processes) - before;
  return 100 * used / std::chrono::duration<double>(steady_clock::now() - begun).count();
}

}  // namespace limb_ring::bench
