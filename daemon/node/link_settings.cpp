#include "node/link_settings.h"

#include <algorithm>

#include "config/core_settings.h"
#include "io/seal.h"
#include "limb_ring/ring_directory.h"
#include "node/agreement.h"
#include "node/key_file.h"

namespace limb_ring::setup {
namespace {

using config::LinkConfig;
using config::NodeConfig;
using config::RingConfig;
using core::Line;

/// Where node `to` listens for node `from`.
link::Endpoint endpoint_between(const NodeConfig& from, const NodeConfig& to, const std::string& directory, Line line) {
  const bool second = line == Line::second;
  const LinkConfig::Transport transport = config::transport_between(from, to);
  if (transport == LinkConfig::Transport::udp)
    return link::Endpoint::udp(to.link.address, second ? to.link.second_port() : to.link.port);
  std::string path = socket_path(directory, std::to_string(to.id), second ? "link2" : "link");
  return transport == LinkConfig::Transport::shm ? link::Endpoint::shm(std::move(path))
                                                 : link::Endpoint::unix_stream(std::move(path));
}

/// Where it listens for the nodes of other hosts; nothing where there are none. By a bypass each of them may come to
/// be its upstream neighbour, however far away it is.
std::optional<link::Endpoint> endpoint_from_hosts(const RingConfig& ring, const NodeConfig& node,
                                                  const std::string& directory, Line line) {
  if (node.link.transport == LinkConfig::Transport::udp) return std::nullopt;  // one endpoint for all
  for (const NodeConfig& other : ring.nodes)
    if (other.host != node.host) return endpoint_between(other, node, directory, line);
  return std::nullopt;
}

/// Ids in the order in which the line runs.
std::vector<std::uint8_t> order_on(const RingConfig& ring, Line line) {
  const core::RingOrder ids = order_of(ring);
  std::vector<std::uint8_t> order(ids.begin(), ids.end());
  if (line == Line::second) std::reverse(order.begin(), order.end());
  return order;
}

/// Of the nodes in that order.
std::vector<std::string> names_on(const RingConfig& ring, Line line) {
  std::vector<std::string> names;
  for (const std::uint8_t id : order_on(ring, line)) names.push_back(ring.find(id)->name);
  return names;
}

link::Timing timing_of(const RingConfig& ring) {
  return {ring.timeouts.idle, ring.timeouts.silence, ring.timeouts.first_successor};
}

bool has_udp_lines(const RingConfig& ring) {
  return std::any_of(ring.nodes.begin(), ring.nodes.end(), [&ring](const NodeConfig& node) {
    return config::transport_between(ring.nodes[0], node) == LinkConfig::Transport::udp ||
           node.link.transport == LinkConfig::Transport::udp;
  });
}

/// Of the UDP lines that run in this direction; none where they are not keyed, or where there are none: a ring of many
/// hosts that is tried out on one machine needs no key there. @throw config::ConfigError
std::shared_ptr<const link::LineKey> key_of(const RingConfig& ring, Line line) {
  if (ring.links.key.empty() || !has_udp_lines(ring)) return nullptr;
  return std::make_shared<link::LineKey>(config::read_key_file(ring.links.key), link::ring_hash(ring.ring),
                                         line == Line::second);
}

link::Identity identity_of(const RingConfig& ring, const NodeConfig& node, Line line) {
  return {link::ring_hash(ring.ring), node.id, agreement_of(ring), key_of(ring, line)};
}

link::InputSettings input_settings(const RingConfig& ring, const NodeConfig& node, const std::string& directory,
                                   Line line) {
  return {identity_of(ring, node, line),
          endpoint_between(node, node, directory, line),
          order_on(ring, line),
          timing_of(ring),
          node.link.delay,
          endpoint_from_hosts(ring, node, directory, line),
          names_on(ring, line)};
}

link::OutputSettings output_settings(const RingConfig& ring, const NodeConfig& node, const std::string& directory,
                                     Line line) {
  link::OutputSettings s{identity_of(ring, node, line), {}, timing_of(ring)};
  const std::size_t at = index_of(ring, node);
  const std::size_t nodes = ring.nodes.size();
  for (std::size_t i = 1; i <= nodes; ++i) {
    const NodeConfig& next = ring.nodes[(at + (line == Line::first ? i : nodes - i)) % nodes];
    s.candidates.push_back({next.id, endpoint_between(node, next, directory, line)});
  }
  return s;
}

}  // namespace

std::vector<LinkSettings> link_settings(const RingConfig& ring, const NodeConfig& node, const std::string& directory) {
  std::vector<LinkSettings> lines;
  for (const Line line : core::Lines(ring.folds_back()))
    lines.push_back({line, input_settings(ring, node, directory, line), output_settings(ring, node, directory, line)});
  return lines;
}

}  // namespace limb_ring::setup
