#include "setup/link_settings.h"

#include <algorithm>

#include "limb_ring/ring_directory.h"
#include "setup/core_settings.h"

namespace limb_ring::setup {
namespace {

using config::LinkConfig;
using config::NodeConfig;
using config::RingConfig;
using core::Line;

link::Endpoint endpoint_of(const NodeConfig& node, const std::string& directory, Line line) {
  const bool second = line == Line::second;
  if (node.link.transport == LinkConfig::Transport::udp)
    return link::Endpoint::udp(node.link.address, second ? node.link.second_port() : node.link.port);
  std::string path = socket_path(directory, std::to_string(node.id), second ? "link2" : "link");
  return node.link.transport == LinkConfig::Transport::shm ? link::Endpoint::shm(std::move(path))
                                                           : link::Endpoint::unix_stream(std::move(path));
}

/// Ids in the order in which the line runs.
std::vector<std::uint8_t> order_on(const RingConfig& ring, Line line) {
  const core::RingOrder ids = order_of(ring);
  std::vector<std::uint8_t> order(ids.begin(), ids.end());
  if (line == Line::second) std::reverse(order.begin(), order.end());
  return order;
}

link::Timing timing_of(const RingConfig& ring) {
  return {ring.timeouts.idle, ring.timeouts.silence, ring.timeouts.first_successor};
}

link::Identity identity_of(const RingConfig& ring, const NodeConfig& node) {
  return {link::ring_hash(ring.ring), node.id};
}

link::InputSettings input_settings(const RingConfig& ring, const NodeConfig& node, const std::string& directory,
                                   Line line) {
  return {identity_of(ring, node), endpoint_of(node, directory, line), order_on(ring, line), timing_of(ring),
          node.link.delay};
}

link::OutputSettings output_settings(const RingConfig& ring, const NodeConfig& node, const std::string& directory,
                                     Line line) {
  link::OutputSettings s{identity_of(ring, node), {}, timing_of(ring)};
  const std::size_t at = index_of(ring, node);
  const std::size_t nodes = ring.nodes.size();
  for (std::size_t i = 1; i <= nodes; ++i) {
    const NodeConfig& next = ring.nodes[(at + (line == Line::first ? i : nodes - i)) % nodes];
    s.candidates.push_back({next.id, endpoint_of(next, directory, line)});
  }
  return s;
}

}  // namespace

std::vector<LinkSettings> link_settings(const RingConfig& ring, const NodeConfig& node, const std::string& directory) {
  std::vector<LinkSettings> lines;
  for (const Line line : core::Lines(ring.redundancy == RingConfig::Redundancy::foldback))
    lines.push_back({line, input_settings(ring, node, directory, line), output_settings(ring, node, directory, line)});
  return lines;
}

}  // namespace limb_ring::setup
