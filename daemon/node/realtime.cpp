#include "node/realtime.h"

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

std::vector<unsigned> allowed_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<unsigned> cores;
  if (sched_getaffinity(0, sizeof set, &set) != 0) return {0};
  for (unsigned core = 0; core < CPU_SETSIZE; ++core)
    if (CPU_ISSET(core, &set)) cores.push_back(core);
  return cores;
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

unsigned core_of(std::size_t place, std::size_t nodes, const std::vector<unsigned>& allowed) {
  return allowed[place * allowed.size() / nodes];
}

void apply_realtime(const config::RingConfig& ring, std::size_t place) {
  const config::Realtime& realtime = ring.realtime;
  if (realtime.auto_cores) pin_to({core_of(place, ring.nodes.size(), allowed_cores())});
  if (!realtime.cores.empty()) pin_to(realtime.cores);
  if (realtime.fifo > 0) ask_for_fifo(realtime.fifo);
  if (realtime.lock_memory) lock_memory();
}

void keep_on_one_core(const config::RingConfig& ring) {
  const int here = sched_getcpu();
  if (!ring.realtime.cores.empty())
    pin_to(ring.realtime.cores);
  else if (here >= 0)
    pin_to({static_cast<unsigned>(here)});
}

}  // namespace limb_ring::runtime
