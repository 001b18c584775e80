#include "config/reach.h"

namespace limb_ring::watchdog {

// The chain begins at the node behind the broken line and ends at the one before it.
Reach reach_of(const core::RingOrder& order, const std::optional<core::BrokenLine>& broken, wire::NodeId from,
               wire::NodeId to) {
  if (!broken) return {};
  const auto in_chain = [&](wire::NodeId node) { return core::distance(order, broken->behind, node); };
  return {in_chain(from) < in_chain(to), in_chain(to) <= in_chain(from)};
}

}  // namespace limb_ring::watchdog
