#include "node/virtual_node_faults.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "io/node_notes.h"

namespace limb_ring::virtual_host {

using fault::Fault;
using fault::Name;
using wire::NodeId;

NodeFaults::NodeFaults(sim::VirtualRing& ring, NodePower& power, fault::RingNodes nodes, std::string folder)
    : ring_(ring), power_(power), nodes_(std::move(nodes)), folder_(std::move(folder)) {
  for (const fault::NamedNode& node : nodes_) live::remove_note(folder_, node.id);
}

NodeFaults::State NodeFaults::state(NodeId node) const {
  const auto found = states_.find(node);
  return found == states_.end() ? State::runs : found->second.state;
}

const std::string& NodeFaults::name_of(NodeId node) const {
  return std::find_if(nodes_.begin(), nodes_.end(), [node](const auto& each) { return each.id == node; })->name;
}

std::string NodeFaults::why_not(Name what, NodeId node) const {
  const std::string name = "node " + name_of(node);
  const State now = state(node);
  if (what == Name::start) return now == State::dead ? "" : name + " runs already";
  if (now == State::dead) return name + " is dead; start it first";
  if (what == Name::power_cycle && now == State::frozen) return name + " is frozen; thaw it first";
  return "";
}

std::string NodeFaults::begin(const Fault& fault) {
  for (const NodeId node : fault.nodes) {
    const std::string problem = why_not(fault.name, node);
    if (!problem.empty()) return problem;
  }
  const std::string problem = fault.name == Name::kill || fault.name == Name::freeze ? note(fault) : "";
  if (!problem.empty()) return problem;
  spdlog::warn("fault on purpose: {}", fault::to_words(fault, nodes_));
  return carry_out(fault);
}

std::string NodeFaults::carry_out(const Fault& fault) {
  if (fault.name == Name::power_cycle) return power_cycle(fault);
  std::string problem;
  for (const NodeId node : fault.nodes) {
    if (fault.name == Name::kill) kill(node);
    if (fault.name == Name::freeze) freeze(node, fault);
    if (fault.name == Name::thaw) thaw(node);
    if (fault.name == Name::start && problem.empty()) problem = start(node);
  }
  return problem;
}

// All nodes go off before the first comes on again.
std::string NodeFaults::power_cycle(const Fault& fault) {
  for (const NodeId node : fault.nodes) kill(node);
  std::string problem;
  for (const NodeId node : fault.nodes) {
    const std::string why = start(node);
    if (why.empty()) continue;
    problem = why;
    Fault dead;
    dead.name = Name::kill;
    dead.nodes = {node};
    note(dead);
  }
  return problem;
}

void NodeFaults::kill(NodeId node) {
  power_.off(node);
  states_[node].state = State::dead;
}

std::string NodeFaults::start(NodeId node) {
  const std::string problem = power_.on(node);
  if (!problem.empty()) return "node " + name_of(node) + " does not start: " + problem;
  states_[node].state = State::runs;
  live::remove_note(folder_, node);
  return "";
}

void NodeFaults::freeze(NodeId node, const Fault& fault) {
  if (!is_frozen(node)) power_.freeze(node);
  Node& frozen = states_[node];
  frozen.state = State::frozen;
  const unsigned nth = ++frozen.freezes;
  if (fault.lasts.count() == 0) return;
  ring_.at(ring_.now() + core::Duration(fault.lasts), [this, node, nth] {
    if (is_frozen(node) && states_[node].freezes == nth) thaw(node);
  });
}

void NodeFaults::thaw(NodeId node) {
  if (!is_frozen(node)) return;
  states_[node].state = State::runs;
  live::remove_note(folder_, node);
  power_.thaw(node);
}

/// Called before the fault begins. If it cannot be noted it is not done, since nobody could see that it is active.
std::string NodeFaults::note(const Fault& fault) const {
  for (const NodeId node : fault.nodes) {
    Fault one = fault;
    one.nodes = {node};
    const std::string problem = live::write_note(folder_, node, fault::to_words(one, nodes_));
    if (!problem.empty()) return forget_new_notes(fault), problem;
  }
  return "";
}

void NodeFaults::forget_new_notes(const Fault& fault) const {
  for (const NodeId node : fault.nodes)
    if (state(node) == State::runs) live::remove_note(folder_, node);
}

}  // namespace limb_ring::virtual_host
