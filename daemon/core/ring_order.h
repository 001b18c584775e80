#pragma once

#include <algorithm>
#include <vector>

#include "wire/packet.h"

namespace limb_ring::core {

/// All configured nodes, by id, as the ring passes them.
using RingOrder = std::vector<wire::NodeId>;

/// Index of the node in the order, from 0; order.size() if it is not in it.
inline std::size_t place_of(const RingOrder& order, wire::NodeId node) {
  return static_cast<std::size_t>(std::find(order.begin(), order.end(), node) - order.begin());
}
inline bool is_in(const RingOrder& order, wire::NodeId node) { return place_of(order, node) < order.size(); }
/// How many lines lead from one node to the other. @pre both are in it
inline std::size_t distance(const RingOrder& order, wire::NodeId from, wire::NodeId to) {
  return (place_of(order, to) + order.size() - place_of(order, from)) % order.size();
}
/// The node that is `lines` lines behind `node` in ring order. @pre `node` is in it
inline wire::NodeId node_after(const RingOrder& order, wire::NodeId node, std::size_t lines) {
  return order[(place_of(order, node) + lines) % order.size()];
}

}  // namespace limb_ring::core
