#include "bench/cores.h"

#include <time.h>

#include <cerrno>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "bench/setup.h"

namespace limb_ring::bench {
namespace {

cpu_set_t allowed_cores() {
  cpu_set_t allowed;
  if (::sched_getaffinity(0, sizeof allowed, &allowed) != 0)
    throw std::system_error(errno, std::generic_category(), "asking for the cores to run on");
  return allowed;
}

}  // namespace

unsigned core_count() {
  const cpu_set_t allowed = allowed_cores();
  return static_cast<unsigned>(CPU_COUNT(&allowed));
}

std::optional<cpu_set_t> cores_for(Pinning pinning) {
  if (pinning == Pinning::free) return {};
  const cpu_set_t allowed = allowed_cores();
  int last = CPU_SETSIZE - 1;
  while (last > 0 && !CPU_ISSET(last, &allowed)) --last;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(last, &one);
  return one;
}

void stay_on(const std::optional<cpu_set_t>& cores) {
  if (cores && ::sched_setaffinity(0, sizeof *cores, &*cores) != 0)
    throw std::system_error(errno, std::generic_category(), "pinning to a core");
}

namespace {

double cpu_seconds(pid_t process) {
  clockid_t clock{};
  timespec used{};
  if (::clock_getcpuclockid(process, &clock) != 0 || ::clock_gettime(clock, &used) != 0)
    throw std::runtime_error("process " + std::to_string(process) + " has ended");
  return static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9;
}

double cpu_seconds(const std::vector<pid_t>& processes) {
  double sum = 0;
  for (const pid_t process : processes) sum += cpu_seconds(process);
  return sum;
}

}  // namespace

CpuShare::CpuShare(std::vector<pid_t> processes) : processes_(std::move(processes)), before_(cpu_seconds(processes_)) {}

double CpuShare::percent() const {
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begun_;
  return 100 * (cpu_seconds(processes_) - before_) / passed.count();
}

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
