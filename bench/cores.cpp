#include "bench/cores.h"

#include <cerrno>
#include <system_error>

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

}  // namespace limb_ring::bench
