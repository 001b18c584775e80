#include "config/plain_ring.h"

#include <algorithm>

#include "config/check_ring.h"
#include "config/names.h"

namespace limb_ring::config {
namespace {

LinkConfig::Transport transport_of(const std::string& word) {
  const auto& words = transport_words();
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) return static_cast<LinkConfig::Transport>(found - words.begin());
  throw ConfigError("transport: '" + word + "' is unknown; allowed: " + join(words));
}

NodeConfig plain_node(std::uint8_t id, const LinkConfig& links) {
  NodeConfig node;
  node.id = id;
  node.name = "node" + std::to_string(id);
  node.link = links;
  node.link.port = static_cast<std::uint16_t>(links.port + id);
  return node;
}

}  // namespace

RingConfig plain_ring(const std::string& ring, unsigned nodes) {
  if (!is_ring_name(ring)) throw ConfigError("ring: '" + ring + "' is no ring name; allowed: " + kRingNameRule);
  if (nodes < kFewestNodes || nodes > kMostNodes)
    throw ConfigError("nodes: '" + std::to_string(nodes) + "' is out of range; allowed: 2 to 255");
  RingConfig config;
  config.ring = ring;
  config.links.port = default_first_port(ring);
  for (unsigned id = 0; id < nodes; ++id)
    config.nodes.push_back(plain_node(static_cast<std::uint8_t>(id), config.links));
  return config;
}

void apply_transport(RingConfig& ring, const std::string& transport) {
  ring.links.transport = transport_of(transport);
  for (NodeConfig& node : ring.nodes) node.link.transport = ring.links.transport;
  const std::string unkeyed = unkeyed_line(ring);
  if (!unkeyed.empty()) throw ConfigError(ring.path + ": " + unkeyed + "; allowed: " + kKeyOrInsecure);
}

void apply_one_host(RingConfig& ring) {
  if (ring.hosts.empty()) return;
  ring.hosts.clear();
  for (NodeConfig& node : ring.nodes) {
    node.host = 0;
    node.link.address = LinkConfig{}.address;
  }
}

void rename_ring(RingConfig& ring, const std::string& name) {
  if (!is_ring_name(name)) throw ConfigError("ring: '" + name + "' is no ring name; allowed: " + kRingNameRule);
  const std::uint16_t before = default_first_port(ring.ring);
  const std::uint16_t after = default_first_port(name);
  ring.ring = name;
  if (ring.links.port != before) return;
  ring.links.port = after;
  for (NodeConfig& node : ring.nodes)
    if (node.link.port == before + node.id) node.link.port = static_cast<std::uint16_t>(after + node.id);
}

std::uint16_t default_first_port(const std::string& ring) {
  std::uint32_t hash = 2166136261u;  // FNV-1a: the same number in every process and build
  for (const char c : ring) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
  return static_cast<std::uint16_t>(17000 + hash % 60 * 256);
}

}  // namespace limb_ring::config
