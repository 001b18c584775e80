#include "ros_bridge/service_request.h"

#include <cmath>
#include <stdexcept>

#include "config/characters.h"
#include "config/quantity.h"
#include "limb_ring/host_port.h"

namespace limb_ring::bridge {
namespace {

constexpr double kShortestTimeout = 1e-3, kLongestTimeout = 60.0;  // s

std::string known_nodes(const config::RingConfig& ring) {
  std::string names;
  for (const auto& node : ring.nodes)
    names += (names.empty() ? "" : ", ") + node.name + " (" + std::to_string(node.id) + ")";
  return names;
}

}  // namespace

std::chrono::milliseconds timeout_of(const ros::Duration& asked, std::chrono::seconds usual) {
  if (asked.isZero()) return usual;
  if (asked.toSec() < kShortestTimeout || asked.toSec() > kLongestTimeout)
    throw std::invalid_argument("timeout of " + config::format_time(std::chrono::nanoseconds(asked.toNSec())) +
                                "; it must be 0 (for " + std::to_string(usual.count()) +
                                " s), or 1 ms to 60 s: to rosservice 2 s are {secs: 2}");
  return std::chrono::milliseconds(std::lround(asked.toSec() * 1000));
}

std::uint8_t one_node(const config::RingConfig& ring, const std::string& node) {
  if (const auto* found = ring.find(node)) return found->id;
  throw std::invalid_argument("no node '" + config::printable(node) + "' in ring " + ring.ring +
                              "; there are: " + known_nodes(ring));
}

std::uint8_t destination_of(const config::RingConfig& ring, const std::string& node) {
  return node == "all" ? kBroadcast : one_node(ring, node);
}

std::vector<ask::Node> nodes_to_ask(const config::RingConfig& ring, const std::string& which) {
  const bool all = which.empty() || which == "all";
  const std::uint8_t only = all ? kBroadcast : one_node(ring, which);
  std::vector<ask::Node> nodes;
  for (const auto& node : ring.nodes)
    if (all || node.id == only) nodes.push_back({node.id, node.name});
  return nodes;
}

}  // namespace limb_ring::bridge
