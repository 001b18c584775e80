#include "config/plain_ring.h"
#include "config/sections.h"
#include "config/urdf_limits.h"

namespace limb_ring::config {
namespace {

const char* const kAllowedNodes = "a list of 2 to 255 nodes, in ring order";

void read_into_roster(const Entry& item) {
  const Option<NodeConfig>& id_option = node_section()[0];
  const Option<NodeConfig>& name_option = node_section()[1];
  const auto id = item.find("id"), name = item.find("name");
  if (!id) return check_names(item, names_of(node_section()), {"id"});
  auto& nodes = item.document().nodes;
  NodeConfig node;
  id_option.read(*id, node);
  node.name = "node" + std::to_string(node.id);
  if (name) name_option.read(*name, node);
  if (!nodes.emplace(std::to_string(node.id), node.id).second)
    id->refuse_value("is another node's id", "ids 0 to 254, each once");
  if (!nodes.emplace(node.name, node.id).second)
    (name ? *name : item).refuse("'" + node.name + "' is another node's name", "each name once");
}

/// Ids and names of all nodes, before anything that may refer to them is read.
void read_roster(const std::vector<Entry>& items) {
  Problems problems;
  for (const Entry& item : items) problems.gather([&] { read_into_roster(item); });
  problems.refuse_all();
}

NodeConfig read_node_map(const Entry& item, const LinkConfig& links, const std::vector<HostConfig>& hosts) {
  NodeConfig node;
  node.link = links;
  node.link.port = 0;
  read_section(item, node_section(), node);
  if (node.name.empty()) node.name = "node" + std::to_string(node.id);
  const auto link = item.find("link");
  const bool own_address = link && link->find("address");
  if (!hosts.empty() && !own_address) node.link.address = hosts[node.host].address;
  if (node.link.port == 0) node.link.port = static_cast<std::uint16_t>(links.port + node.id);
  return node;
}

void read_nodes(const Entry& entry, RingConfig& ring) {
  entry.document().nodes_unsure = true;
  const std::vector<Entry> items = entry.items(kAllowedNodes, kMostNodes);
  if (items.size() < kFewestNodes)
    entry.refuse("a list of " + std::to_string(items.size()) + " is too short", kAllowedNodes);
  if (ring.links.port == 0) ring.links.port = default_first_port(ring.ring);
  Problems problems;
  entry.document().nodes_unsure = !problems.gather([&] { read_roster(items); });
  for (const Entry& item : items)
    problems.gather([&] { ring.nodes.push_back(read_node_map(item, ring.links, ring.hosts)); });
  problems.refuse_all();
}

/// Until 0.1.0 one entry stood for three waits.
void read_timeouts(const Entry& entry, RingConfig& ring) {
  if (entry.is_map())
    if (const auto bypass = entry.find("bypass"))
      bypass->refuse("is three entries now", "first_successor, break_grace, fold_permission");
  read_section(entry, timeouts_section(), ring.timeouts);
}

}  // namespace

// Read in this order: nodes take their links from `links`, and their joints' limits from `urdf`, and name their host;
// the supervisor, the bridge's topics and the traffic name nodes.
const Section<RingConfig>& ring_section() {
  static const Section<RingConfig> section{
      name_option("ring", &RingConfig::ring, is_ring_name, kRingNameRule, kRequired,
                  "Name of the ring, by which programs find it."),
      choice_option("redundancy", &RingConfig::redundancy, {"none", "foldback"},
                    "foldback: a second line, against the ring, closes it again around a break. With udp a node "
                    "listens there at its port + 256."),
      section_option("limits", &RingConfig::limits, limits_section(), "Sizes of the queues."),
      {"timeouts", "{}", "a map, see below", "Waits and periods.", read_timeouts},
      section_option("links", &RingConfig::links, links_section(),
                     "What every node's link has unless it says otherwise."),
      section_option("firmware", &RingConfig::firmware, firmware_section(),
                     "The limb nodes' program and its simulated servos."),
      section_option("realtime", &RingConfig::realtime, realtime_section(),
                     "What the daemons ask of the kernel; where refused they say so and go on."),
      {"urdf", "none", "a path, from the folder of this file, or absolute, or package://PACKAGE/PATH",
       "A URDF, from which the joints have their `type` and limits (`lower`, `upper`, `velocity`, `effort`), by their "
       "names. A limit that is given here as well is as it is here. A velocity or an effort that is 0 or missing there "
       "is unknown: it has its default, and a warning names all such joints. A continuous joint, as of a wheel, needs "
       "no limits; limb_firmware stops it at 2147 rad. A mimic joint has no motor and belongs to no node: joint_states "
       "have it beside the joint that it follows.",
       [](const Entry& entry, RingConfig&) { read_urdf(entry); }},
      hosts_option(),
      section_option("recorder", &RingConfig::recorder, recorder_section(),
                     "Each node writes down what goes into its network controller and what comes out, for `ringctl "
                     "record check`."),
      {"nodes", kRequired, "a list of 2 to 255 maps, see below",
       "The nodes in ring order: each sends to the next, the last to the first.", read_nodes},
      section_option("supervisor", &RingConfig::supervisor, supervisor_section(),
                     "Who watches the CPUs that have an `alive_period`, and what is done about a hung one."),
      section_option("virtual", &RingConfig::virtual_clock, virtual_clock_section(),
                     "The ring on a virtual clock (ringctl up --clock virtual)."),
      section_option("bridge", &RingConfig::bridge, bridge_section(), "The ROS side of the ring."),
      traffic_option(),
  };
  return section;
}

}  // namespace limb_ring::config
