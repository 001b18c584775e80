#include "tools/ringctl/ring_access.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "config/ring_config.h"
#include "io/in_parallel.h"
#include "io/node_notes.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/ring_folder.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {

using std::chrono::steady_clock;

namespace {

std::size_t index_of(const std::vector<NodeName>& nodes, std::uint8_t id) {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [id](const NodeName& node) { return node.id == id; });
  if (found == nodes.end()) throw HostPortError("a daemon that is not in its own ring: " + std::to_string(id));
  return static_cast<std::size_t>(found - nodes.begin());
}

/// @param look called now and then while it waits; it may throw
RingDescription described_by(const std::string& ring, const std::string& node, const std::function<void()>& look) {
  HostPort port = connect_node(ring, node, Stay::asks_only, look);
  status::Configured config;
  const std::string wrong = status::read(ask(port, {{"do", "config"}}, kAnswerTime, look), config);
  if (!wrong.empty()) throw HostPortError("node " + node + ": " + ask::sentence_of_shape(wrong));
  RingDescription described;
  described.ring = ring;
  for (const auto& one : config.nodes) described.nodes.push_back({one.id, one.name, one.host});
  described.answered = index_of(described.nodes, port.id());
  described.hosts = config.hosts;
  described.path = config.path;
  described.folds_back = config.folds_back;
  described.beacon = std::chrono::milliseconds(config.beacon_ms);
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

  /// One after the other, as nearly always the first one answers; if one lets us wait, all that are left at once.
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
    process::in_parallel(nodes.size(), nodes.size(), [&](std::size_t i) {
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

HostPort RingAccess::connect(const NodeName& node, Stay stay) const {
  require_here(node);
  return connect_node(ring(), std::to_string(node.id), stay);
}

HostPortError gone(const HostPort& port, const std::string& reason) {
  return HostPortError("node " + label({port.id(), port.name()}) + " of ring " + port.ring() + ": " + reason);
}

namespace {

/// Who has come by sudo most likely means a ring of his own.
std::string whose_else() {
  const char* user = std::getenv("SUDO_USER");
  if (::geteuid() != 0 || user == nullptr || *user == '\0') return "";
  return std::string("; these are root's rings, those of ") + user + " are seen without sudo";
}

std::string valid(const std::string& ring) {
  try {
    ring_directory(ring);
  } catch (const std::invalid_argument& problem) {
    throw UsageError(problem.what());
  }
  return ring;
}

}  // namespace

std::string named_ring(const std::string& given) {
  if (!given.empty()) return valid(given);
  const char* environment = std::getenv("LIMB_RING_RING");
  return environment != nullptr && *environment != '\0' ? valid(environment) : "";
}

std::string choose_ring(const std::string& given) {
  const std::string named = named_ring(given);
  if (!named.empty()) return named;
  std::vector<std::string> rings = running_rings();
  if (rings.empty()) rings = live::held_rings();  // their daemons live, but none can be connected to
  if (rings.empty()) {
    const std::vector<std::string> killed = live::killed_rings();
    if (killed.size() == 1) return killed.front();
    const std::string unreadable = why_unreadable(rings_directory());
    if (!unreadable.empty()) throw NoRing(rings_directory() + unreadable);
    throw NoRing("no ring is running (looked in " + rings_directory() + ")" + whose_else());
  }
  if (rings.size() == 1) return rings.front();
  throw UsageError("several rings are running: " + config::join(rings) + "; choose one with --ring");
}

std::string choose_ring(const std::string& argument, const std::string& option) {
  if (!argument.empty() && !option.empty() && argument != option) throw UsageError("RING and --ring name two rings");
  return choose_ring(argument.empty() ? option : argument);
}

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

using nlohmann::json;

namespace {

/// Below this the ring is on time: it goes on in steps.
constexpr double kOnTime = 0.005;

std::string seconds(double value) { return app::number(value, 3) + " s"; }

}  // namespace

void require_clock_goes(const std::string& ring) {
  const std::string standing = standing_clock(ring);
  if (!standing.empty()) throw NotKnown(standing + ", and what was asked for may happen then");
}

std::string pace_text(const json& pace) {
  if (!pace.is_number()) return "max";
  char text[32];
  std::snprintf(text, sizeof text, "%g", pace.get<double>());
  return text;
}

std::string clock_words(const json& clock) {
  if (!clock.is_object()) return "";
  const double late = clock.at("late_s").get<double>(), lost = clock.at("lost_s").get<double>();
  const char* stands = clock.value("paused", false) ? " stands" : "";
  return std::string("; virtual clock") + stands + " at " + seconds(clock.at("now_s").get<double>()) + ", pace " +
         pace_text(clock.at("pace")) + (clock.contains("allowed_ns") ? ", following another" : "") +
         (late >= kOnTime ? ", " + seconds(late) + " late" : "") + (lost > 0 ? ", " + seconds(lost) + " lost" : "");
}

using std::chrono::milliseconds;

namespace {

constexpr milliseconds kAnswerTick{50};

[[noreturn]] void no_answer(const HostPort& port, milliseconds timeout) {
  require_clock_goes(port.ring());
  throw HostPortError("node " + label({port.id(), port.name()}) + " of ring " + port.ring() +
                      " did not answer within " + std::to_string(timeout.count()) + " ms");
}

nlohmann::json checked(const HostPort& port, const std::string& text) {
  const nlohmann::json answer = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!answer.is_object())
    throw HostPortError("node " + label({port.id(), port.name()}) + ": " +
                        ask::sentence_of_shape("it is not a JSON object"));
  if (!answer.contains("error") || !answer["error"].is_string()) return answer;
  const std::string problem = answer["error"].get<std::string>();
  if (!port.connected()) throw gone(port, problem);  // not the daemon's word, but that of the connection to it
  throw NotDone(problem);
}

}  // namespace

nlohmann::json ask(HostPort& port, const nlohmann::json& request, milliseconds timeout) {
  Progress progress(port.ring());
  return ask(port, request, timeout, [&] { progress.tell("waiting for node " + label({port.id(), port.name()})); });
}

nlohmann::json ask(HostPort& port, const nlohmann::json& request, milliseconds timeout,
                   const std::function<void()>& tick) {
  const auto deadline = steady_clock::now() + timeout;
  const std::uint32_t token = port.request(request.dump());
  while (steady_clock::now() < deadline) {
    const auto message = port.receive(kAnswerTick);
    if (!message)
      tick();
    else if (const auto* reply = std::get_if<Reply>(&*message); reply && reply->token == token)
      return checked(port, reply->json);
    else if (const auto* end = std::get_if<Disconnected>(&*message))
      throw gone(port, end->reason);
  }
  no_answer(port, timeout);
}

std::vector<ask::Answer> ask_all(const std::string& ring, const std::vector<NodeName>& nodes,
                                 const nlohmann::json& request, Deadline deadline) {
  return ask::RingClient(ring, nodes).ask(request, std::min(deadline, steady_clock::now() + kAnswerTime));
}

std::vector<ask::ToldRow> ask_for_rows(const std::string& ring, const std::vector<NodeName>& nodes, Deadline deadline) {
  return ask::RingClient(ring, nodes).status(std::min(deadline, steady_clock::now() + kAnswerTime));
}

}  // namespace limb_ring::ringctl
