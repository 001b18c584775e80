#include "link/endpoint.h"

namespace limb_ring::link {

std::string to_string(const Endpoint& endpoint) {
  if (endpoint.transport != Endpoint::Transport::udp) return endpoint.path;
  return endpoint.address + ":" + std::to_string(endpoint.port);
}

std::uint64_t ring_hash(const std::string& name) {
  std::uint64_t hash = 0xCBF29CE484222325u;
  for (const char c : name) hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x100000001B3u;
  return hash;
}

}  // namespace limb_ring::link
