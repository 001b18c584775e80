#include "config/ring_config.h"

#include <algorithm>

#include "config/address.h"

namespace limb_ring::config {

Pins default_pins() {
  Pins pins;
  pins[0].action = PinConfig::Action::reset;
  pins[1].action = PinConfig::Action::stop;
  pins[2].action = PinConfig::Action::sync;
  return pins;
}

std::vector<std::uint8_t> RingConfig::node_ids() const {
  std::vector<std::uint8_t> ids;
  for (const NodeConfig& node : nodes) ids.push_back(node.id);
  return ids;
}

const NodeConfig* RingConfig::find(std::uint8_t id) const {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [id](const NodeConfig& node) { return node.id == id; });
  return found == nodes.end() ? nullptr : &*found;
}

const NodeConfig* RingConfig::find(const std::string& id_or_name) const {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [&](const NodeConfig& node) {
    return node.name == id_or_name || std::to_string(node.id) == id_or_name;
  });
  return found == nodes.end() ? nullptr : &*found;
}

std::string RingConfig::name_of(std::uint8_t id) const {
  const NodeConfig* node = find(id);
  return node != nullptr ? node->name : std::to_string(id);
}

const HostConfig* RingConfig::find_host(const std::string& name) const {
  const auto found =
      std::find_if(hosts.begin(), hosts.end(), [&](const HostConfig& host) { return host.name == name; });
  return found == hosts.end() ? nullptr : &*found;
}

const HostConfig* RingConfig::host_of(const NodeConfig& node) const {
  return node.host < hosts.size() ? &hosts[node.host] : nullptr;
}

LinkConfig::Transport transport_between(const NodeConfig& from, const NodeConfig& to) {
  return from.host == to.host ? to.link.transport : LinkConfig::Transport::udp;
}

const std::vector<std::string>& transport_words() {
  static const std::vector<std::string> words{"unix", "shm", "udp"};
  return words;
}

const char* words_of(LinkConfig::Transport transport) {
  switch (transport) {
    case LinkConfig::Transport::unix_stream:
      return "a UNIX stream";
    case LinkConfig::Transport::shm:
      return "shared memory";
    case LinkConfig::Transport::udp:
      break;
  }
  return "UDP";
}

bool hears_other_hosts(const RingConfig& ring, const NodeConfig& node) {
  if (is_loopback(node.link.address)) return false;
  if (node.link.transport == LinkConfig::Transport::udp) return true;
  return std::any_of(ring.nodes.begin(), ring.nodes.end(),
                     [&](const NodeConfig& other) { return other.host != node.host; });
}

const NodeConfig& body_of(const RingConfig& ring) {
  for (const NodeConfig& node : ring.nodes)
    if (node.cpu.kind == CpuConfig::Kind::attached) return node;
  return ring.nodes.front();
}

const NodeConfig& supervisor_of(const RingConfig& ring) {
  return ring.supervisor.node ? *ring.find(*ring.supervisor.node) : body_of(ring);
}

std::optional<std::uint8_t> first_pin(const NodeConfig& node, PinConfig::Action action) {
  for (std::uint8_t factor = 0; factor < node.pins.size(); ++factor)
    if (node.pins[factor].action == action) return factor;
  return std::nullopt;
}

bool ring_has_reset_on(const RingConfig& ring, unsigned factor) {
  return std::any_of(ring.nodes.begin(), ring.nodes.end(), [factor](const NodeConfig& node) {
    return factor < node.pins.size() && node.pins[factor].action == PinConfig::Action::reset;
  });
}

}  // namespace limb_ring::config
