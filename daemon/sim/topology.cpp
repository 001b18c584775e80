// The virtual ring's lines and lives: who is next to whom, and what a fault does to that.
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

void VirtualRing::disconnect_output(NodeId id) {
  Node& from = nodes_[id];
  if (from.successor < 0) return;
  Node& to = nodes_[from.successor];
  ++from.line_epoch;
  if (from.alive) from.controller->output_lost(now_);
  tell_fault(id, Fault::output_replaced);
  if (to.alive && to.predecessor == id) {
    to.controller->input_lost(now_);
    to.predecessor = -1;
    touch(static_cast<NodeId>(from.successor));
  }
  from.successor = -1;
  touch(id);
}

void VirtualRing::connect(NodeId id) {
  Node& from = nodes_[id];
  const int next = next_alive(id);
  if (!from.alive || from.wire_cut || next < 0 || next == from.successor) return;
  disconnect_output(id);
  Node& to = nodes_[next];
  if (to.predecessor >= 0 && to.predecessor != id) disconnect_output(static_cast<NodeId>(to.predecessor));
  from.successor = next;
  to.predecessor = id;
  to.controller->input_up(id, now_);
  from.controller->output_up(static_cast<NodeId>(next), now_);
  touch(id);
  touch(static_cast<NodeId>(next));
}

// The neighbours close the ring without this node.
void VirtualRing::leave(NodeId id) {
  const int before = previous_alive(id);
  if (before >= 0 && before != id) disconnect_output(static_cast<NodeId>(before));
  disconnect_output(id);
  wakes_.set(id, kNever);
  nodes_[id].alive = false;
  nodes_[id].predecessor = -1;
  if (before >= 0 && before != id) connect(static_cast<NodeId>(before));
}

// The neighbours close the ring with this node in it.
void VirtualRing::enter(NodeId id) {
  nodes_[id].alive = true;
  const int before = previous_alive(id);
  if (before != id) connect(static_cast<NodeId>(before));
  connect(id);
}

void VirtualRing::tell_fault(NodeId id, Fault fault) {
  for (Witness* witness : witnesses_) witness->fault(id, fault, now_);
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
  n.controller = std::make_unique<Controller>(settings_of(id));
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
  node(id).input_lost(now_);
  node(id).output_lost(now_);
  enter(id);
}

void VirtualRing::cut(NodeId id) {
  Node& from = nodes_[id];
  if (from.wire_cut) return;
  tell_fault(id, Fault::cut);
  from.wire_cut = true;
  ++from.line_epoch;  // what is under way is gone
  if (from.successor < 0) return;
  nodes_[from.successor].controller->input_lost(now_);
  touch(static_cast<NodeId>(from.successor));
}

void VirtualRing::heal(NodeId id) {
  Node& from = nodes_[id];
  if (!from.wire_cut) return;
  tell_fault(id, Fault::healed);
  from.wire_cut = false;
  ++from.line_epoch;
  if (from.successor < 0 || from.successor != next_alive(id)) return connect(id);
  nodes_[from.successor].controller->input_up(id, now_);
  touch(static_cast<NodeId>(from.successor));
}

}  // namespace limb_ring::sim
