#include "config/load_ring.h"

#include <filesystem>
#include <utility>

#include "config/check_ring.h"
#include "config/sections.h"
#include "config/urdf_limits.h"
#include "config/yaml_file.h"

namespace limb_ring::config {
namespace {

void default_outputs(std::vector<TopicConfig>& topics) {
  for (TopicConfig& topic : topics)
    if (topic.output.empty()) topic.output = topic.input;
}

/// The key's file, beside the ring's.
void find_key(RingConfig& ring) {
  if (ring.links.key.empty()) return;
  const auto folder = std::filesystem::absolute(ring.path).parent_path();
  ring.links.key = (folder / ring.links.key).lexically_normal();  // an absolute one stays as it is
  for (NodeConfig& node : ring.nodes) node.link.key = ring.links.key;
}

/// A line within a host crosses no network.
void expect_of_networks_alone(RingConfig& ring) {
  for (std::size_t n = 0; n < ring.nodes.size() && !ring.hosts.empty(); ++n) {
    const NodeConfig& from = ring.nodes[(n + ring.nodes.size() - 1) % ring.nodes.size()];
    if (from.host == ring.nodes[n].host) ring.nodes[n].link.expected = {};
  }
}

/// A scenario, taken for the file of a ring.
void refuse_scenario(const Entry& file) {
  if (!file.is_map()) return;
  for (const char* name : {"scenario", "steps", "always", "never"})
    if (const auto entry = file.find(name))
      entry->refuse("this is a scenario, not the file of a ring", "'ringctl scenario run FILE' for a scenario");
}

}  // namespace

RingConfig parse_ring(const std::string& text, const std::string& name) {
  Document document;
  document.name = name;
  const Entry file(parse_yaml(text, name), "", document);
  RingConfig ring;
  ring.path = name;
  refuse_scenario(file);
  read_section(file, ring_section(), ring);
  default_outputs(ring.bridge.topics);
  find_key(ring);
  expect_of_networks_alone(ring);
  check_ring(file, ring);
  take_followers(document.urdf, ring);
  ring.warnings = urdf_warnings(document);
  ring.files = std::move(document.files);
  ring.files.push_back({name, text});
  return ring;
}

RingConfig load_ring(const std::string& path) { return parse_ring(read_file(path), path); }

}  // namespace limb_ring::config
