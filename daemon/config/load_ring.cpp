#include "config/load_ring.h"

#include "config/check_ring.h"
#include "config/sections.h"
#include "config/yaml_file.h"

namespace limb_ring::config {
namespace {

void default_outputs(std::vector<TopicConfig>& topics) {
  for (TopicConfig& topic : topics)
    if (topic.output.empty()) topic.output = topic.input;
}

}  // namespace

RingConfig parse_ring(const std::string& text, const std::string& name) {
  Document document{name, {}, {}, {}};
  const Entry file(parse_yaml(text, name), "", document);
  RingConfig ring;
  ring.path = name;
  read_section(file, ring_section(), ring);
  default_outputs(ring.bridge.topics);
  check_ring(file, ring);
  return ring;
}

RingConfig load_ring(const std::string& path) { return parse_ring(read_file(path), path); }

}  // namespace limb_ring::config
