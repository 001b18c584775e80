#include "app/ringctl/ring_access.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/common/text_table.h"
#include "app/ringctl/answers.h"
#include "app/ringctl/choose_ring.h"
#include "app/ringctl/connect_node.h"
#include "app/ringctl/progress.h"
#include "app/ringctl/ring_folder.h"
#include "config/names.h"
#include "limb_ring/ring_directory.h"
#include "live/lock_files.h"
#include "live/node_notes.h"

namespace limb_ring::ringctl {

namespace {

std::vector<NodeName> names_of(const nlohmann::json& config) {
  std::vector<NodeName> nodes;
  for (const auto& node : config.at("nodes"))
    nodes.push_back({node.at("id").get<std::uint8_t>(), node.at("name").get<std::string>(), node.value("host", "")});
  return nodes;
}

std::vector<RingHost> hosts_of(const nlohmann::json& config) {
  std::vector<RingHost> hosts;
  for (const auto& host : config.value("hosts", nlohmann::json::array()))
    hosts.push_back({host.value("name", ""), host.value("address", ""), host.value("ssh", "")});
  return hosts;
}

std::size_t index_of(const std::vector<NodeName>& nodes, std::uint8_t id) {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [id](const NodeName& node) { return node.id == id; });
  if (found == nodes.end()) throw NoRing("a daemon that is not in its own ring: " + std::to_string(id));
  return static_cast<std::size_t>(found - nodes.begin());
}

RingDescription described_by(const std::string& ring, const std::string& node) {
  HostPort port = connect_node(ring, node);
  const nlohmann::json config = ask(port, {{"do", "config"}}, kAnswerTime);
  RingDescription described;
  described.ring = ring;
  described.nodes = names_of(config);
  described.answered = index_of(described.nodes, port.id());
  described.hosts = hosts_of(config);
  described.path = config.value("path", "");
  described.folds_back = config.value("folds_back", false);
  described.beacon = std::chrono::milliseconds(config.value("beacon_ms", 0));
  return described;
}

/// Whom to ask, and who is frozen, and would only keep us waiting.
struct Daemons {
  std::vector<std::string> answering;
  std::size_t frozen = 0;
};

Daemons daemons_of(const std::string& ring, const std::string& first) {
  Daemons daemons;
  if (!first.empty() && first != "all") daemons.answering.push_back(first);
  for (const std::uint8_t id : node_sockets(ring)) {
    if (live::is_frozen(ring_directory(ring), id))
      ++daemons.frozen;
    else
      daemons.answering.push_back(std::to_string(id));
  }
  return daemons;
}

std::size_t killed_nodes(const std::string& folder) {
  const auto nodes = live::known_nodes(folder);
  return static_cast<std::size_t>(std::count_if(
      nodes.begin(), nodes.end(), [&](const live::KnownNode& node) { return live::is_killed(folder, node.id); }));
}

}  // namespace

RingAccess RingAccess::open(const std::string& ring, const std::string& first) {
  const std::string folder = ring_directory(ring), unreadable = why_unreadable(folder);
  if (!unreadable.empty()) throw NoRing("ring " + ring + ": " + folder + unreadable);
  std::string why = "it has no sockets in " + folder;
  Progress progress;
  const Daemons daemons = daemons_of(ring, first);
  for (const std::string& node : daemons.answering) {
    try {
      return RingAccess(described_by(ring, node));
    } catch (const HostPortError& problem) {
      why = problem.what();
    }
    if (&node != &daemons.answering.back()) progress.tell("node " + node + " does not answer, asking another");
  }
  if (daemons.frozen != 0)
    throw AllFrozen("no daemon of ring " + ring + " answers: " + app::counted(daemons.frozen, "node") +
                    " frozen; 'ringctl fault clear' thaws them");
  const std::size_t killed = killed_nodes(folder);
  if (killed != 0)
    throw NoRing("no daemon of ring " + ring + " answers: " + app::counted(killed, "node") +
                 " killed on purpose; 'ringctl fault clear' starts what was killed");
  if (!live::held_nodes(folder).empty()) throw NoRing("ring " + ring + " runs, but no daemon of it answers: " + why);
  std::vector<std::string> others = running_rings();
  others.erase(std::remove(others.begin(), others.end(), ring), others.end());
  throw NoRing("ring " + ring + " does not run: " + why + (others.empty() ? "" : "; running: " + config::join(others)));
}

RingAccess RingAccess::open_also_dead(const std::string& ring) {
  try {
    return open(ring);
  } catch (const NoRing&) {
    const std::string folder = ring_directory(ring);
    RingDescription described;
    described.ring = ring;
    bool noted = false;
    for (const live::KnownNode& node : live::known_nodes(folder)) {
      described.nodes.push_back({node.id, node.name});
      noted = noted || live::note_of(folder, node.id).has_value() || live::is_frozen(folder, node.id);
    }
    if (!noted) throw;
    return RingAccess(described);
  }
}

std::vector<NodeName> RingAccess::nodes_here() const {
  std::vector<NodeName> here;
  for (const NodeName& node : nodes())
    if (!is_elsewhere(node)) here.push_back(node);
  return here;
}

void RingAccess::require_here(const NodeName& node) const {
  if (!is_elsewhere(node)) return;
  for (const RingHost& host : hosts())
    if (host.name == node.host)
      throw Elsewhere(
          "node " + label(node) + " is on host " + host.name + " (" + host.address + "), this is host " + here(),
          host.ssh, ring());
}

const NodeName& RingAccess::node(const std::string& id_or_name) const {
  for (const NodeName& node : nodes())
    if (id_or_name == node.name || id_or_name == std::to_string(node.id)) return node;
  throw unknown_node(id_or_name, ring(), nodes());
}

std::uint8_t RingAccess::destination(const std::string& id_or_name_or_all) const {
  return id_or_name_or_all == "all" ? kBroadcast : node(id_or_name_or_all).id;
}

const NodeName& RingAccess::source(const std::string& id_or_name) const {
  return id_or_name.empty() ? answered() : node(id_or_name);
}

std::vector<ask::Node> RingAccess::ask_nodes() const {
  std::vector<ask::Node> nodes;
  for (const NodeName& node : ring_.nodes) nodes.push_back({node.id, node.name});
  return nodes;
}

HostPort RingAccess::connect(const NodeName& node, Stay stay) const {
  require_here(node);
  return connect_node(ring(), std::to_string(node.id), stay);
}

}  // namespace limb_ring::ringctl
