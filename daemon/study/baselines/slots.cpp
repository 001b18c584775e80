#include "study/baselines/slots.h"

namespace limb_ring::study {

namespace {
constexpr NodeId kSlotMaster{0};
}

// The master is before all others and, once the frame is home, behind them.
Duration Slots::to(NodeId destination) const {
  return (destination == kSlotMaster ? medium_.nodes : destination) * medium_.relay_delay;
}

void Slots::begin(NodeId node, Time at_master) {
  Node& n = nodes_[node];
  n.repeated = {};
  if (!n.at_master.empty() && n.at_master.front().home <= at_master) {
    n.repeated = n.at_master.front();
    n.at_master.pop_front();
  }
  n.own = {};
  const std::size_t head = queues_.head(node, at_master + node * medium_.relay_delay);
  if (head != kNone) n.own = {head, queues_.take(head, bytes_), Time{}};
}

void Slots::end(NodeId node, Time at_master, Deliveries& deliveries) {
  Node& n = nodes_[node];
  if (n.repeated.whole) deliveries.put(n.repeated.message, at_master + to(messages_[n.repeated.message].destination));
  if (!n.own.whole) return;  // the parts before the last one take the same way, ahead of it
  const NodeId destination = messages_[n.own.message].destination;
  if (destination == kSlotMaster || destination > node)
    deliveries.put(n.own.message, at_master + to(destination));
  else
    n.at_master.push_back({n.own.message, true, at_master + to(kSlotMaster)});
}

}  // namespace limb_ring::study
