#include "ros_bridge/ring_watch.h"

#include <ros/console.h>

#include <initializer_list>
#include <utility>

#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "ros_bridge/status_conversion.h"
#include "wire/control_message.h"

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

constexpr auto kStatusConnect = 100ms;
constexpr auto kStatusAnswer = 500ms;
constexpr auto kStatusRetry = 1s;  // a node that is not there, or on another host, is not asked in vain all the time

const json& heard_in(const json& row) {
  static const json nobody = json::array();
  const auto found = row.find("heard");
  return found != row.end() && found->is_array() ? *found : nobody;
}

/// What is not as docs/reference/requests.md has it, and would be taken for a node's; empty: nothing.
std::string wrong_in(const json& row) {
  if (!row.is_object()) return "it is no JSON object";
  if (row.contains("heard") && !row["heard"].is_array()) return "'heard' is no list";
  for (const json& heard : heard_in(row))
    if (!heard.is_object() || !heard.value("id", json()).is_number_integer())
      return "in 'heard' is what has no whole number 'id'";
  return "";
}

json essence(const json& object, std::initializer_list<const char*> members) {
  json result = json::array();
  for (const char* member : members)
    result.push_back(object.is_object() && object.contains(member) ? object[member] : json());
  return result;
}

}  // namespace

RingWatch::RingWatch(const config::RingConfig& ring, const ConnectOptions& daemon) : ring_(ring), daemon_(daemon) {
  daemon_.role = Role::tool;
  daemon_.alive_period = 0ms;
  daemon_.timeout = kStatusConnect;
}

bool RingWatch::is_frozen(const std::string& node) const {
  const auto* configured = ring_.find(node);
  const std::string folder = ring_directory(daemon_.ring, daemon_.runtime);
  return configured != nullptr && live::is_frozen(folder, configured->id);
}

std::optional<json> RingWatch::ask(const std::string& node) {
  if (is_frozen(node)) return std::nullopt;  // it would let all others wait
  Peer& peer = peers_[node];
  if (!peer.port && Clock::now() < peer.next_try) return std::nullopt;
  try {
    if (!peer.port) {
      auto daemon = daemon_;
      daemon.node = node;
      peer.port.emplace(HostPort::connect(daemon));
    }
    json row = json::parse(peer.port->ask(R"({"do":"status"})", kStatusAnswer), nullptr, /*allow_exceptions=*/false);
    if (!is_right(row, node, peer)) return std::nullopt;
    return row;
  } catch (const std::exception&) {
    // A node that does not answer shows as such in the status; there is no one to tell.
    peer.port.reset();
    peer.next_try = Clock::now() + kStatusRetry;
    return std::nullopt;
  }
}

bool RingWatch::is_right(const json& row, const std::string& node, Peer& peer) {
  const std::string wrong = wrong_in(row);
  const bool is_news = std::exchange(peer.told, wrong) != wrong;
  if (is_news && !wrong.empty())
    ROS_WARN("the daemon of node '%s' answers no status that can be read, and counts as silent: %s", node.c_str(),
             wrong.c_str());
  return wrong.empty();
}

std::string RingWatch::digest() {
  const auto row = ask(daemon_.node);
  if (!row) return "";
  json digest = essence(*row, {"state", "ring_size"});
  if (row->contains("cpu")) digest.push_back(essence((*row)["cpu"], {"state", "boots"}));
  for (const auto& heard : heard_in(*row))
    digest.push_back(essence(heard, {"id", "boot", "cpu_boots", "cpu_state", "stop_latched"}));
  return digest.dump();
}

void RingWatch::notice_boots(const json& own) {
  for (const json& heard : heard_in(own)) {
    const auto id = heard["id"].get<std::uint8_t>();
    const auto boot = static_cast<std::uint64_t>(number_of(heard, "boot", 0));
    if (boots_.take(id, boot, static_cast<std::uint32_t>(number_of(heard, "cpu_boots", 0)))) restarted_.push_back(id);
  }
}

std::vector<NodeStatus> RingWatch::poll() {
  const auto own = ask(daemon_.node);
  if (own) notice_boots(*own);
  const auto fresh = wire::kMissedBeacons * ring_.timeouts.beacon;
  std::vector<NodeStatus> all;
  for (const auto& node : ring_.nodes) {
    NodeStatus status = unheard_node(node);
    const auto row = node.name == daemon_.node ? own : ask(node.name);
    if (row) merge_status_row(*row, status);
    if (own)
      for (const auto& heard : heard_in(*own))
        if (heard["id"] == node.id) merge_beacon(heard, fresh, status);
    all.push_back(std::move(status));
  }
  return all;
}

}  // namespace limb_ring::bridge
