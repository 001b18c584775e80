#include "config/ring_config.h"

#include <algorithm>
#include <numeric>

#include "config/load_ring.h"
#include "config/quantity.h"

namespace limb_ring::config {

Pins default_pins() {
  Pins pins;
  pins[0].action = PinConfig::Action::reset;
  pins[1].action = PinConfig::Action::stop;
  pins[2].action = PinConfig::Action::sync;
  return pins;
}

std::string unfit(const payload::SensorReading& reading, const std::vector<SensorConfig>& sensors) {
  const bool is_imu = reading.kind == payload::SensorReading::Kind::imu;
  const std::size_t place = reading.sensor;
  if (place < sensors.size() && is_imu == (sensors[place].kind == SensorConfig::Kind::imu)) return {};
  return std::string("a reading of ") + (is_imu ? "an IMU" : "a force sensor") + " as sensor " + std::to_string(place) +
         " (from 0), which the ring's file does not give it";
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

const char* name_of(PinConfig::Action action) {
  switch (action) {
    case PinConfig::Action::none:
      return "none";
    case PinConfig::Action::reset:
      return "reset";
    case PinConfig::Action::stop:
      return "stop";
    case PinConfig::Action::signal:
      return "signal";
    case PinConfig::Action::notify:
      return "notify";
    case PinConfig::Action::sync:
      return "sync";
    case PinConfig::Action::exec:
      return "exec";
  }
  return "";
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

namespace {

/// Letters, digits and `others` alone, 1 to `most` characters.
bool consists_of(const std::string& name, const std::string& others, std::size_t most) {
  return !name.empty() && name.size() <= most && std::all_of(name.begin(), name.end(), [&](char c) {
    return is_letter(c) || is_digit(c) || others.find(c) != std::string::npos;
  });
}

/// Levenshtein's distance: insertions, deletions and replacements between two words.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

bool is_node_name(const std::string& name) { return consists_of(name, "_", 32) && is_letter(name[0]) && name != "all"; }

bool is_host_name(const std::string& name) { return is_part_name(name) && name != "all"; }

bool is_part_name(const std::string& name) { return consists_of(name, "_-.", 64) && is_letter(name[0]); }

bool is_joint_name(const std::string& name) {
  return consists_of(name, "_-./", 64) && name[0] != '-' && name[0] != '.';
}

bool is_sensor_name(const std::string& name) { return consists_of(name, "_", 64) && is_letter(name[0]); }

bool is_topic_name(const std::string& name) {
  if (name.empty() || !(is_letter(name[0]) || name[0] == '/')) return false;
  const bool tidy = name.find("//") == std::string::npos && name.back() != '/';
  return tidy && consists_of(name, "_/", 200);
}

std::string closest(const std::string& word, const std::vector<std::string>& candidates) {
  if (word.size() > 64) return {};  // no typing error, and the search is quadratic
  std::string best;
  // Two edits at least, as two swapped letters are; but some of the word must be left.
  std::size_t least = std::min(word.size() / 4 + 2, word.size());
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance >= least) continue;
    least = distance;
    best = candidate;
  }
  return best;
}

std::string join(const std::vector<std::string>& words, const std::string& between) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : between) + word;
  return all;
}

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
  if (!is_ring_name(ring)) throw ConfigError("ring: '" + ring + "' is not a ring name; allowed: " + kRingNameRule);
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
  if (!is_ring_name(name)) throw ConfigError("ring: '" + name + "' is not a ring name; allowed: " + kRingNameRule);
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
