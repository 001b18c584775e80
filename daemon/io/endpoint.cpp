#include "io/endpoint.h"

namespace limb_ring::link {

std::string to_string(const Endpoint& endpoint) {
  if (endpoint.transport != Endpoint::Transport::udp) return endpoint.path;
  return endpoint.address + ":" + std::to_string(endpoint.port);
}

std::uint64_t ring_hash(const std::string& name) { return text_hash(name); }

}  // namespace limb_ring::link
