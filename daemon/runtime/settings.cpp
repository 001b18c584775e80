#include "runtime/settings.h"

#include "limb_ring/ring_directory.h"
#include "setup/core_settings.h"

namespace limb_ring::runtime {
namespace {

using config::LinkConfig;
using config::NodeConfig;
using config::RingConfig;

link::Endpoint endpoint_of(const NodeConfig& node, const std::string& directory) {
  if (node.link.transport == LinkConfig::Transport::udp)
    return link::Endpoint::udp(node.link.address, node.link.port);
  return link::Endpoint::unix_stream(socket_path(directory, std::to_string(node.id), "link"));
}

link::Timing timing_of(const RingConfig& ring) {
  return {ring.timeouts.idle, ring.timeouts.silence, ring.timeouts.bypass};
}

link::Identity identity_of(const RingConfig& ring, const NodeConfig& node) {
  return {link::ring_hash(ring.ring), node.id};
}

}  // namespace

link::InputSettings input_settings(const RingConfig& ring, const NodeConfig& node, const std::string& directory) {
  return {identity_of(ring, node), endpoint_of(node, directory), setup::order_of(ring), timing_of(ring), node.link.delay};
}

link::OutputSettings output_settings(const RingConfig& ring, const NodeConfig& node, const std::string& directory) {
  link::OutputSettings s{identity_of(ring, node), {}, timing_of(ring)};
  const std::size_t at = setup::index_of(ring, node);
  for (std::size_t i = 1; i <= ring.nodes.size(); ++i) {
    const NodeConfig& next = ring.nodes[(at + i) % ring.nodes.size()];
    s.candidates.push_back({next.id, endpoint_of(next, directory)});
  }
  return s;
}

}  // namespace limb_ring::runtime
