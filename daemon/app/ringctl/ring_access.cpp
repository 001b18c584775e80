#include "app/ringctl/ring_access.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/common/text_table.h"
#include "app/ringctl/answers.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/progress.h"
#include "config/names.h"
#include "limb_ring/ring_directory.h"
#include "live/lock_files.h"
#include "live/node_notes.h"

namespace limb_ring::ringctl {

namespace fs = std::filesystem;

namespace {

std::string valid(const std::string& ring) {
  try {
    ring_directory(ring);
  } catch (const std::invalid_argument& problem) {
    throw UsageError(problem.what());
  }
  return ring;
}

}  // namespace

std::string why_unreadable(const std::string& folder) {
  std::error_code error;
  fs::directory_iterator(folder, error);
  return error && error != std::errc::no_such_file_or_directory ? ": " + error.message() : "";
}

namespace {

/// The id in "12.host"; nothing for another file, such as the link of the node's name.
std::optional<std::uint8_t> socket_id(const fs::path& file) {
  const std::string stem = file.stem().string();
  const bool number = !stem.empty() && stem.size() <= 3 && stem.find_first_not_of("0123456789") == std::string::npos;
  if (file.extension() != ".host" || !number || std::stoul(stem) >= kBroadcast) return {};
  return static_cast<std::uint8_t>(std::stoul(stem));
}

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

/// The order in which to ask daemons: frozen ones last, because they would keep us waiting.
std::vector<std::string> whom_to_ask(const std::string& ring, const std::string& first) {
  std::vector<std::string> nodes, frozen;
  if (!first.empty() && first != "all") nodes.push_back(first);
  for (const std::uint8_t id : node_sockets(ring)) {
    const bool waits = live::holder_of(ring_directory(ring), id).frozen;
    (waits ? frozen : nodes).push_back(std::to_string(id));
  }
  nodes.insert(nodes.end(), frozen.begin(), frozen.end());
  return nodes;
}

std::size_t killed_nodes(const std::string& folder) {
  const auto nodes = live::known_nodes(folder);
  return static_cast<std::size_t>(std::count_if(
      nodes.begin(), nodes.end(), [&](const live::KnownNode& node) { return live::is_killed(folder, node.id); }));
}

}  // namespace

std::string label(const NodeName& node) { return std::to_string(node.id) + " (" + node.name + ")"; }

UsageError unknown_node(const std::string& word, const std::string& ring, const std::vector<NodeName>& nodes) {
  std::vector<std::string> labels, names;
  for (const NodeName& node : nodes) {
    labels.push_back(label(node));
    names.push_back(node.name);
  }
  const std::string meant = config::closest(word, names);
  return UsageError("unknown node '" + word + "'" + (meant.empty() ? ". " : ", did you mean '" + meant + "'? ") +
                    "Ring " + ring + " has: " + config::join(labels));
}

std::string choose_ring(const std::string& given) {
  if (!given.empty()) return valid(given);
  const char* environment = std::getenv("LIMB_RING_RING");
  if (environment != nullptr && *environment != '\0') return valid(environment);
  const std::vector<std::string> rings = running_rings();
  if (rings.empty()) {
    const std::vector<std::string> killed = live::killed_rings();
    if (killed.size() == 1) return killed.front();
    const std::string unreadable = why_unreadable(rings_directory());
    if (!unreadable.empty()) throw NoRing(rings_directory() + unreadable);
    throw NoRing("no ring is running (looked in " + rings_directory() + ")");
  }
  if (rings.size() == 1) return rings.front();
  throw UsageError("several rings are running: " + config::join(rings) + "; choose one with --ring");
}

std::vector<std::uint8_t> node_sockets(const std::string& ring) {
  std::vector<std::uint8_t> ids;
  std::error_code error;
  const fs::directory_iterator folder(ring_directory(ring), error);
  for (auto it = fs::begin(folder); !error && it != fs::end(folder); it.increment(error))
    if (const auto id = socket_id(it->path())) ids.push_back(*id);
  std::sort(ids.begin(), ids.end());
  return ids;
}

RingAccess RingAccess::open(const std::string& ring, const std::string& first) {
  const std::string folder = ring_directory(ring), unreadable = why_unreadable(folder);
  if (!unreadable.empty()) throw NoRing("ring " + ring + ": " + folder + unreadable);
  std::string why = "it has no sockets in " + folder;
  Progress progress;
  for (const std::string& node : whom_to_ask(ring, first)) {
    try {
      return RingAccess(described_by(ring, node));
    } catch (const HostPortError& problem) {
      why = problem.what();
    }
    progress.tell("node " + node + " does not answer, asking another");
  }
  const std::size_t killed = killed_nodes(folder);
  if (killed != 0)
    throw NoRing("no daemon of ring " + ring + " answers: " + app::counted(killed, "node") +
                 " killed on purpose; 'ringctl fault clear' starts what was killed");
  throw NoRing("ring " + ring + " does not run: " + why);
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
      noted = noted || live::note_of(folder, node.id).has_value();
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

HostPort RingAccess::connect(const NodeName& node) const {
  require_here(node);
  return connect_node(ring(), std::to_string(node.id));
}

HostPortError gone(const HostPort& port, const std::string& reason) {
  return HostPortError("node " + label({port.id(), port.name()}) + " of ring " + port.ring() + ": " + reason);
}

HostPort connect_node(const std::string& ring, const std::string& node) {
  ConnectOptions options;
  options.ring = ring;
  options.node = node;
  options.timeout = std::chrono::milliseconds(0);
  return HostPort::connect(options);
}

}  // namespace limb_ring::ringctl
