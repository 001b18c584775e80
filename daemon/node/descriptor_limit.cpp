#include "node/descriptor_limit.h"

#include <sys/resource.h>

#include "node/host_server.h"

namespace limb_ring::runtime {
namespace {

/// Beside its clients: both lines, timers, files, its CPU, and handshakes that are under way.
constexpr unsigned kOfTheNode = 48;

}  // namespace

std::string too_few_descriptors(const config::RingConfig& ring) {
  const rlim_t needed = kOfTheNode + ring.limits.clients + host::HostServer::kKeptPlaces;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= needed) return "";
  return "only " + std::to_string(limit.rlim_cur) +
         " file descriptors may be open (ulimit -n), this node needs up to " + std::to_string(needed);
}

}  // namespace limb_ring::runtime
