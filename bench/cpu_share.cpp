#include "bench/cpu_share.h"

#include <time.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace limb_ring::bench {
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

}  // namespace limb_ring::bench
