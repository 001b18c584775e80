#include "node/virtual_node.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <string>

#include "io/node_notes.h"
#include "node/session.h"

namespace limb_ring::virtual_host {

using core::Line;
using runtime::LineEnds;
using runtime::LinkChange;

bool VirtualBreaker::mended() const {
  return world_.faults.cut(id_, line_) || world_.ring.successor(id_, line_).has_value();
}

VirtualNode::VirtualNode(const VirtualWorld& world, wire::NodeId id, runtime::DriverListener& listener)
    : world_(world),
      clock_(world.ring, world.on_expired),
      id_(id),
      listener_(listener),
      first_(world, id, Line::first),
      second_(world, id, Line::second),
      started_(world.ring.time_of(id)) {}

LineEnds VirtualNode::ends(Line line) const {
  const auto number = [](std::optional<wire::NodeId> node) {
    return node ? std::optional<std::uint8_t>(std::uint8_t{*node}) : std::nullopt;
  };
  return {number(world_.ring.predecessor(id_, line)), number(world_.ring.successor(id_, line))};
}

static_assert(runtime::SendOwner::of(runtime::SendOwner::Kind::ring_user).to_core() == sim::VirtualRing::kUser);

// Sends that the ring's own user (VirtualRing::kUser) made for this CPU end with the CPU.
void VirtualNode::cpu_reset(core::Owner owner) {
  controller().apply(core::input::CpuReset{owner}, now());
  world_.ring.reset_cpu(id_);
}

void VirtualNode::on_event(const core::Event& event) {
  if (const auto* change = std::get_if<core::StateChanged>(&event.what))
    if (change->after == core::NodeState::open_chain || change->after == core::NodeState::folded) broken_since_ = now();
  if (!closed_) listener_.on_event(event);
}

void VirtualNode::on_given_out() {
  if (closed_) return;
  const std::size_t waiting = controller().received_waiting();
  listener_.on_round_end();
  if (controller().received_waiting() != waiting) pump();
}

void VirtualNode::on_arrival(const wire::Slice& slice, core::Time now) {
  link::InputCounters& in = in_[index(world_.ring.input_line(id_))];
  ++in.slices;
  in.bytes += wire::kSliceHeaderSize + slice.bytes.size;
  if (tap_ == nullptr) return;
  const auto from = world_.ring.predecessor(id_, world_.ring.input_line(id_));
  tap_->on_input(slice, from.value_or(wire::kBroadcast), VirtualClock::at(now));
}

void VirtualNode::on_departure(const wire::Slice& slice, core::Time now) {
  out_[index(world_.ring.output_line(id_))].bytes += wire::kSliceHeaderSize + slice.bytes.size;
  if (tap_ == nullptr) return;
  const auto to = world_.ring.successor(id_, world_.ring.output_line(id_));
  if (!to) return;
  framed_.put(slice.kind, slice.bytes);
  tap_->on_output(framed_.view(), *to, VirtualClock::at(now));
  framed_.clear();
}

void VirtualNode::look_at_lines() {
  for (const Line line : controller().lines()) {
    LineEnds& known = ends_[static_cast<std::size_t>(line)];
    const LineEnds before = std::exchange(known, ends(line));
    tell_change(line, before, known);
  }
}

void VirtualNode::tell_change(Line line, const LineEnds& before, const LineEnds& after) {
  const event_loop::NodeClock::Time now = clock_.now();
  if (before.from && before.from != after.from) {
    if (tap_ != nullptr) tap_->on_input_gap(now);
    if (line == Line::first) input_lost_at_ = this->now();
    if (!after.from) tell({line, true, LinkChange::Is::lost});
  }
  if (before.to && before.to != after.to) {
    if (tap_ != nullptr) tap_->on_output_gap(now);
    if (!after.to) tell({line, false, LinkChange::Is::lost});
  }
  if (after.from && before.from != after.from) tell({line, true, LinkChange::Is::up, after.from});
  if (after.to && before.to != after.to) tell({line, false, LinkChange::Is::up, after.to});
}

void VirtualNode::tell(const LinkChange& change) {
  if (!closed_) listener_.on_link(change);
}

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
  if (what == Name::step_clock && ring_.is_guest(node))
    return "node " + name_of(node) + " is foreign: only its own code knows its clocks";
  const State now = state(node);
  if (fault::after(what, now)) return "";
  const std::string name = "node " + name_of(node);
  switch (now) {
    case State::runs:
      return name + " runs already";
    case State::dead:
      return name + " is dead; start it first";
    case State::frozen:
      return name + (what == Name::start ? " runs already" : " is frozen; thaw it first");
  }
  return "";
}

std::string NodeFaults::begin(const Fault& fault) {
  for (const NodeId node : fault.nodes) {
    const std::string problem = why_not(fault.name, node);
    if (!problem.empty()) return problem;
  }
  const std::string problem = fault.name == Name::kill || fault::freezes(fault.name) ? note(fault) : "";
  if (!problem.empty()) return problem;
  spdlog::warn("fault on purpose: {}", fault::to_words(fault, nodes_));
  return carry_out(fault);
}

std::string NodeFaults::carry_out(const Fault& fault) {
  if (fault.name == Name::power_cycle) return power_cycle(fault);
  if (fault.name == Name::step_clock) return sim::step_clocks(ring_, fault), "";
  std::string problem;
  for (const NodeId node : fault.nodes) {
    if (fault.name == Name::kill) kill(node);
    if (fault::freezes(fault.name)) freeze(node, fault);
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
  if (!is_frozen(node)) power_.freeze(node, fault.name == Name::suspend);
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
