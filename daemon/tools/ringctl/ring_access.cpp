#include "tools/ringctl/ring_access.h"

#include <algorithm>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "config/names.h"
#include "io/in_parallel.h"
#include "io/node_notes.h"
#include "limb_ring/ring_directory.h"
#include "ring/lock_files.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/answer_shape.h"
#include "tools/ringctl/answers.h"
#include "tools/ringctl/choose_ring.h"
#include "tools/ringctl/connect_node.h"
#include "tools/ringctl/progress.h"
#include "tools/ringctl/ring_folder.h"

namespace limb_ring::ringctl {

using std::chrono::steady_clock;

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
  if (found == nodes.end()) throw HostPortError("a daemon that is not in its own ring: " + std::to_string(id));
  return static_cast<std::size_t>(found - nodes.begin());
}

/// @param look called now and then while it waits; it may throw
RingDescription described_by(const std::string& ring, const std::string& node, const std::function<void()>& look) {
  HostPort port = connect_node(ring, node, Stay::asks_only, look);
  const nlohmann::json config = ask(port, {{"do", "config"}}, kAnswerTime, look);
  const std::string wrong = wrong_in_config(config);
  if (!wrong.empty()) throw HostPortError("node " + node + ": " + sentence_of_shape(wrong));
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

constexpr std::chrono::milliseconds kWithOneAlone{500};  ///< with one daemon, before all are asked

/// Looks for a daemon that describes its ring.
class Search {
 public:
  Search(std::string ring, Deadline deadline) : ring_(std::move(ring)), deadline_(deadline) {}

  /// One after the other, as nearly always the first one answers; where one lets us wait, all that are left at once.
  std::optional<RingDescription> among(const std::vector<std::string>& nodes) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const auto now = steady_clock::now();
      if (now >= deadline_) break;
      const auto until = now + std::min<steady_clock::duration>(kWithOneAlone, (deadline_ - now) / 2);
      try {
        return described_by(ring_, nodes[i], [until] {
          if (steady_clock::now() >= until) throw Waits();
        });
      } catch (const HostPortError& problem) {
        why_ = problem.what();
      } catch (const Waits&) {
        return among_all({nodes.begin() + static_cast<std::ptrdiff_t>(i), nodes.end()});
      }
    }
    return std::nullopt;
  }
  /// What was wrong with the last one; empty: none was asked.
  const std::string& why() const { return why_; }

 private:
  struct Waits {};

  std::optional<RingDescription> among_all(const std::vector<std::string>& nodes) {
    process::in_parallel(nodes.size(), kAskers, [&](std::size_t i) {
      try {
        found(described_by(ring_, nodes[i], [&] { look(nodes.front()); }));
      } catch (const HostPortError& problem) {
        const std::lock_guard<std::mutex> lock(mutex_);
        why_ = problem.what();
      } catch (const Waits&) {
      }
    });
    return std::move(found_);
  }

  void look(const std::string& silent) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (found_) throw Waits();
    const std::string words = "node " + silent + " does not answer";
    if (steady_clock::now() < deadline_) return progress_.tell(words + ", asking all others");
    why_ = words;
    throw Waits();
  }

  void found(RingDescription description) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!found_) found_ = std::move(description);
  }

  std::string ring_;
  Deadline deadline_;
  std::mutex mutex_;
  std::string why_;
  std::optional<RingDescription> found_;
  Progress progress_;
};

std::size_t killed_nodes(const std::string& folder) {
  const auto nodes = live::known_nodes(folder);
  return static_cast<std::size_t>(std::count_if(
      nodes.begin(), nodes.end(), [&](const live::KnownNode& node) { return live::is_killed(folder, node.id); }));
}

}  // namespace

RingAccess RingAccess::open(const std::string& ring, const std::string& first, Deadline deadline) {
  const std::string folder = ring_directory(ring), unreadable = why_unreadable(folder);
  if (!unreadable.empty()) throw NoRing("ring " + ring + ": " + folder + unreadable);
  std::string why = "it has no sockets in " + folder;
  const Daemons daemons = daemons_of(ring, first);
  Search search(ring, deadline);
  if (auto described = search.among(daemons.answering)) return RingAccess(std::move(*described));
  if (!search.why().empty()) why = search.why();
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
