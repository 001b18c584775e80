#pragma once

#include <optional>

#include "core/membership/known_break.h"
#include "core/ring_order.h"

namespace limb_ring::watchdog {

/// Between two nodes: whether packets of the first reach the second, and packets of the second the first.
/// In an open chain it is one of the two, never both. (ours)
struct Reach {
  bool sends = true;  ///< packets of the one reach the other
  bool hears = true;  ///< beacons of the other reach the one
};

/// From node `from` to node `to`.
/// @param order ids in ring order. @pre all nodes named are in it
/// @param broken the broken line; none: the ring is closed, and everything reaches everybody
Reach reach_of(const core::RingOrder& order, const std::optional<core::BrokenLine>& broken, wire::NodeId from,
               wire::NodeId to);

}  // namespace limb_ring::watchdog
