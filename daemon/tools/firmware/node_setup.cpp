#include "tools/firmware/node_setup.h"

#include "config/load_ring.h"

namespace limb_ring::firmware {
namespace {

std::string nodes_of(const config::RingConfig& ring) {
  std::string list;
  for (const auto& node : ring.nodes) list += (list.empty() ? "" : ", ") + std::to_string(node.id) + " " + node.name;
  return list;
}

const config::NodeConfig& find_node(const config::RingConfig& ring, const Options& options) {
  const auto* node = ring.find(options.node);
  if (node) return *node;
  throw OptionsError("no node '" + options.node + "' in " + options.config + "; it has: " + nodes_of(ring));
}

}  // namespace

ProgramSetup make_setup(const Options& options) {
  ProgramSetup setup;
  setup.ring = options.ring;
  if (options.config.empty()) return setup;
  const auto ring = config::load_ring(options.config);
  if (setup.ring.empty()) setup.ring = ring.ring;
  setup.cpu.node = find_node(ring, options);
  if (setup.cpu.node.cpu.alive_period.count() != 0) setup.alive_period = setup.cpu.node.cpu.alive_period;
  setup.cpu.firmware = ring.firmware;
  setup.cpu.command_timeout = ring.timeouts.command;
  setup.cpu.state_to = config::body_of(ring).id;
  return setup;
}

}  // namespace limb_ring::firmware
