#include "ros_bridge/ring_watch.h"

#include <ros/console.h>

#include <algorithm>
#include <utility>

#include "ros_bridge/status_conversion.h"
#include "wire/control_message.h"

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;

constexpr auto kStatusAnswer = 500ms;
constexpr auto kStatusRetry = 1s;  // a node that is not there, or on another host, is not asked in vain all the time

std::vector<ask::Node> nodes_of(const config::RingConfig& ring) {
  std::vector<ask::Node> nodes;
  for (const config::NodeConfig& node : ring.nodes) nodes.push_back({node.id, node.name});
  return nodes;
}

ask::RingClient::Deadline soon() { return std::chrono::steady_clock::now() + kStatusAnswer; }

}  // namespace

RingWatch::RingWatch(const config::RingConfig& ring, const ConnectOptions& daemon)
    : ring_(ring),
      client_(daemon.ring, nodes_of(ring), live::Stay::for_long, daemon.runtime),
      own_(static_cast<std::size_t>(ring.find(daemon.node) - ring.nodes.data())),
      told_(ring.nodes.size()) {
  client_.pause = kStatusRetry;
}

void RingWatch::tell(std::size_t node, const ask::ToldRow& row) {
  const std::string wrong = row.unreadable ? row.why_not : "";
  if (std::exchange(told_[node], wrong) != wrong && row.unreadable)
    ROS_WARN("the status of node '%s' cannot be read, and its daemon counts as silent: %s",
             ring_.nodes[node].name.c_str(), wrong.c_str());
}

std::string RingWatch::digest() {
  const ask::ToldRow own = client_.status_of(own_, soon());
  tell(own_, own);
  if (!own.said) return "";
  const status::NodeRow& row = *own.said;
  std::string digest = row.state + ' ' + std::to_string(row.ring_size.value_or(0)) + ' ' + row.cpu.state + ' ' +
                       std::to_string(row.cpu.boots.value_or(0));
  for (const status::Heard& heard : row.heard)
    digest += '\n' + std::to_string(heard.id) + ' ' + std::to_string(heard.boot) + ' ' +
              std::to_string(heard.beacon.cpu_boots) + ' ' + heard.cpu_state() +
              (heard.beacon.stop_latched ? " stopped" : "");
  return digest;
}

void RingWatch::notice_boots(const status::NodeRow& own) {
  for (const status::Heard& heard : own.heard)
    if (boots_.take(heard.id, heard.boot, heard.beacon.cpu_boots)) restarted_.push_back(heard.id);
}

std::vector<NodeStatus> RingWatch::poll() {
  const std::vector<ask::ToldRow> told = client_.status(soon());
  const auto& own = told[own_].said;
  if (own) notice_boots(*own);
  const auto fresh = wire::kMissedBeacons * ring_.timeouts.beacon;
  std::vector<NodeStatus> all;
  for (std::size_t i = 0; i < told.size(); ++i) {
    NodeStatus status = unheard_node(ring_.nodes[i]);
    tell(i, told[i]);
    if (told[i].said) merge_status_row(*told[i].said, status);
    if (own)
      for (const status::Heard& heard : own->heard)
        if (heard.id == status.id) merge_beacon(heard, fresh, status);
    all.push_back(std::move(status));
  }
  return all;
}

}  // namespace limb_ring::bridge
