#include "judge/due_pins.h"

#include <algorithm>

namespace limb_ring::sim {

void DuePins::put(wire::NodeId source, wire::Factor factor, core::Time at, bool sure) {
  due_.push_back({source, factor, at, sure});
}

void DuePins::pulled(const core::PinPulled& pin, core::Time at) {
  const auto is_it = [&](const Due& due) {
    return due.source == pin.source && due.factor == pin.factor && due.at == at;
  };
  // Two may be due in one instant. The pull is that of the one which must be there.
  const auto is_surely_it = [&](const Due& due) { return due.sure && is_it(due); };
  auto it = std::find_if(due_.begin(), due_.end(), is_surely_it);
  if (it == due_.end()) it = std::find_if(due_.begin(), due_.end(), is_it);
  if (it != due_.end()) return static_cast<void>(due_.erase(it));
  complain_(Promise::exactly_once, "node " + std::to_string(node_) + " pulled pin " + std::to_string(pin.factor) +
                                       " for node " + std::to_string(pin.source) +
                                       ", and no new INTP had come in that says so");
}

void DuePins::drop_before(core::Time now) {
  for (; !due_.empty() && due_.front().at < now; due_.pop_front())
    if (due_.front().sure)
      complain_(Promise::exactly_once, "node " + std::to_string(node_) + " did not pull pin " +
                                           std::to_string(due_.front().factor) + " for an INTP of node " +
                                           std::to_string(due_.front().source));
}

}  // namespace limb_ring::sim
