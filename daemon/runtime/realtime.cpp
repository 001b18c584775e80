#include "runtime/realtime.h"

#include <sched.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

namespace limb_ring::runtime {
namespace {

void pin_to(const std::vector<unsigned>& cores) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const unsigned core : cores) CPU_SET(core, &set);
  if (sched_setaffinity(0, sizeof set, &set) != 0)
    spdlog::warn("realtime.cores: {} (does this machine have these cores?); going on unpinned", std::strerror(errno));
}

void ask_for_fifo(int priority) {
  sched_param param{};
  param.sched_priority = priority;
  if (sched_setscheduler(0, SCHED_FIFO, &param) != 0)
    spdlog::warn("realtime.fifo: {} (needs CAP_SYS_NICE or an rtprio limit); going on without", std::strerror(errno));
}

void lock_memory() {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    spdlog::warn("realtime.lock_memory: {} (needs CAP_IPC_LOCK or a memlock limit); going on without",
                 std::strerror(errno));
}

}  // namespace

void apply_realtime(const config::Realtime& realtime) {
  if (!realtime.cores.empty()) pin_to(realtime.cores);
  if (realtime.fifo > 0) ask_for_fifo(realtime.fifo);
  if (realtime.lock_memory) lock_memory();
}

}  // namespace limb_ring::runtime
