#include "watchdog/reach.h"

#include <algorithm>

namespace limb_ring::watchdog {
namespace {

std::size_t place(const std::vector<wire::NodeId>& order, wire::NodeId node) {
  return static_cast<std::size_t>(std::find(order.begin(), order.end(), node) - order.begin());
}

}  // namespace

// The chain begins at the node behind the broken line and ends at the one before it.
Reach reach_of(const std::vector<wire::NodeId>& order, const std::optional<core::BrokenLine>& broken, wire::NodeId from,
               wire::NodeId to) {
  if (!broken) return {};
  const auto in_chain = [&](wire::NodeId node) {
    return (place(order, node) + order.size() - place(order, broken->behind)) % order.size();
  };
  return {in_chain(from) < in_chain(to), in_chain(to) <= in_chain(from)};
}

}  // namespace limb_ring::watchdog
