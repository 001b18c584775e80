// The virtual ring's lines, starts and ends of nodes: who is next to whom, and what a fault does to that.
#include <algorithm>

#include "sim/virtual_ring.h"

namespace limb_ring::sim {

using core::kNever;

int VirtualRing::next_alive(NodeId id) const {
  for (unsigned i = 1; i <= nodes_.size(); ++i)
    if (nodes_[(id + i) % nodes_.size()].alive) return static_cast<int>((id + i) % nodes_.size());
  return -1;
}

int VirtualRing::previous_alive(NodeId id) const {
  const std::size_t n = nodes_.size();
  for (std::size_t i = 1; i <= n; ++i)
    if (nodes_[(id + n - i) % n].alive) return static_cast<int>((id + n - i) % n);
  return -1;
}

// ---- what a node is told of its lines -----------------------------------------------------

void VirtualRing::input_up(NodeId id, NodeId from, Way way) {
  Node& n = nodes_[id];
  touch(id);
  if (way == Way::second) return n.fold->second_input_up(from);
  n.fold ? n.fold->input_up(from, now_) : n.controller->input_up(from, now_);
}

void VirtualRing::input_lost(NodeId id, Way way) {
  Node& n = nodes_[id];
  touch(id);
  if (way == Way::second) return n.fold->second_input_lost(now_);
  n.fold ? n.fold->input_lost(now_) : n.controller->input_lost(now_);
}

void VirtualRing::output_up(NodeId id, NodeId to, Way way) {
  Node& n = nodes_[id];
  touch(id);
  if (way == Way::second) return n.fold->second_output_up(now_);
  n.fold ? n.fold->output_up(to, now_) : n.controller->output_up(to, now_);
}

void VirtualRing::output_lost(NodeId id, Way way) {
  Node& n = nodes_[id];
  touch(id);
  if (way == Way::second) return n.fold->second_output_lost(now_);
  n.fold ? n.fold->output_lost(now_) : n.controller->output_lost(now_);
}

// ---- who is next to whom ------------------------------------------------------------------

void VirtualRing::disconnect_output(NodeId id, Way way) {
  Line& out = line(id, way);
  if (out.successor < 0) return;
  const auto to = static_cast<NodeId>(out.successor);
  ++out.epoch;
  if (alive(id)) output_lost(id, way);
  tell_fault(id, Fault::output_replaced, way);
  if (alive(to) && line(to, way).predecessor == id) {
    input_lost(to, way);
    line(to, way).predecessor = -1;
  }
  out.successor = -1;
}

void VirtualRing::connect(NodeId id, Way way) {
  Line& out = line(id, way);
  const int next = this->next(id, way);
  if (!alive(id) || out.cut || next < 0 || next == out.successor) return;
  disconnect_output(id, way);
  const auto to = static_cast<NodeId>(next);
  const int former = line(to, way).predecessor;
  if (former >= 0 && former != id) disconnect_output(static_cast<NodeId>(former), way);
  out.successor = next;
  line(to, way).predecessor = id;
  input_up(to, id, way);
  output_up(id, to, way);
}

// The neighbours close the ring without this node.
void VirtualRing::leave(NodeId id) {
  std::array<int, 2> before{-1, -1};
  each_way([&](Way way) {
    int& b = before[static_cast<std::size_t>(way)];
    b = this->before(id, way);
    if (b >= 0 && b != id) disconnect_output(static_cast<NodeId>(b), way);
    disconnect_output(id, way);
    line(id, way).predecessor = -1;
  });
  wakes_.set(id, kNever);
  nodes_[id].alive = false;
  each_way([&](Way way) {
    const int b = before[static_cast<std::size_t>(way)];
    if (b >= 0 && b != id) connect(static_cast<NodeId>(b), way);
  });
}

// The neighbours close the ring with this node in it.
void VirtualRing::enter(NodeId id) {
  nodes_[id].alive = true;
  each_way([&](Way way) {
    const int before = this->before(id, way);
    if (before != id) connect(static_cast<NodeId>(before), way);
    connect(id, way);
  });
}

void VirtualRing::tell_fault(NodeId id, Fault fault, Way way) {
  for (Witness* witness : witnesses_) witness->fault(id, fault, now_, way);
}

void VirtualRing::kill(NodeId id) {
  if (!alive(id)) return;
  leave(id);
  tell_fault(id, Fault::killed);
}

void VirtualRing::start(NodeId id) {
  if (alive(id)) return;
  Node& n = nodes_[id];
  ++n.lives;
  make_node(id);
  n.controller->set_cpu_present(true);
  tell_fault(id, Fault::started);
  enter(id);
}

void VirtualRing::freeze(NodeId id) {
  if (!alive(id)) return;
  leave(id);
  tell_fault(id, Fault::frozen);
}

void VirtualRing::thaw(NodeId id) {
  if (alive(id)) return;
  tell_fault(id, Fault::thawed);
  each_way([&](Way way) {
    input_lost(id, way);
    output_lost(id, way);
  });
  enter(id);
}

void VirtualRing::cut(NodeId id, Way way) {
  Line& out = line(id, way);
  if (out.cut) return;
  tell_fault(id, Fault::cut, way);
  out.cut = true;
  ++out.epoch;  // what is under way is gone
  if (out.successor >= 0) input_lost(static_cast<NodeId>(out.successor), way);
}

void VirtualRing::heal(NodeId id, Way way) {
  Line& out = line(id, way);
  if (!out.cut) return;
  tell_fault(id, Fault::healed, way);
  out.cut = false;
  ++out.epoch;
  if (out.successor < 0 || out.successor != next(id, way)) return connect(id, way);
  input_up(static_cast<NodeId>(out.successor), id, way);
}

void VirtualRing::cut_cable(NodeId id) {
  const auto after = static_cast<NodeId>((id + 1) % size());
  cut(id);
  cut(after, Way::second);
  if (line(id).successor == after && alive(id)) disconnect_output(id, Way::first);
  if (line(after, Way::second).successor == id && alive(after)) disconnect_output(after, Way::second);
}

void VirtualRing::heal_cable(NodeId id) {
  heal(id);
  heal(static_cast<NodeId>((id + 1) % size()), Way::second);
}

}  // namespace limb_ring::sim
