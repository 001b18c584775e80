// The virtual ring's lines, starts and ends of nodes: who is next to whom, and what a fault does to that.

#include "sim/virtual_ring.h"

namespace limb_ring::sim {

using core::kNever;

int VirtualRing::next_alive(NodeId id) const {
  for (std::size_t lines = 1; lines <= order().size(); ++lines)
    if (const NodeId next = core::node_after(order(), id, lines); reaches(id, next)) return next;
  return -1;
}

int VirtualRing::previous_alive(NodeId id) const {
  for (std::size_t lines = order().size(); lines-- > 0;)
    if (const NodeId before = core::node_after(order(), id, lines); reaches(id, before)) return before;
  return -1;
}

std::optional<NodeId> VirtualRing::predecessor(NodeId id, Line line) const {
  const int before = nodes_[id].lines[static_cast<std::size_t>(line)].predecessor;
  if (before < 0 || !successor(static_cast<NodeId>(before), line)) return std::nullopt;
  return static_cast<NodeId>(before);
}

std::optional<NodeId> VirtualRing::successor(NodeId id, Line line) const {
  const Wire& out = nodes_[id].lines[static_cast<std::size_t>(line)];
  if (out.cut || out.successor < 0) return std::nullopt;
  return static_cast<NodeId>(out.successor);
}

// ---- what a node is told of its lines -----------------------------------------------------

// A guest says itself when it has connected.
void VirtualRing::input_up(NodeId id, NodeId from, Line line) {
  if (Guest* guest = nodes_[from].guest) guest->wired_to(id);
  if (Guest* guest = nodes_[id].guest)
    guest->wired_from(from);
  else if (nodes_[from].guest == nullptr)
    attach_input(id, from, line);
}

void VirtualRing::attach_input(NodeId id, NodeId from, Line line) {
  notice(id, line, true);
  end_of(id, line, true).told = from;
  touch(id);
  for (Observer* observer : observers_) observer->input_changes(id, line, now_);
  nodes_[id].controller->apply(core::input::InputUp{line, from}, time_of(id));
}

void VirtualRing::input_lost(NodeId id, Line line) {
  touch(id);
  for (Observer* observer : observers_) observer->input_changes(id, line, now_);
  if (nodes_[id].guest != nullptr) return nodes_[id].guest->input_gone();
  nodes_[id].controller->apply(core::input::InputLost{line}, time_of(id));
}

void VirtualRing::output_up(NodeId id, NodeId to, Line line) {
  if (nodes_[id].guest == nullptr && nodes_[to].guest == nullptr) attach_output(id, to, line);
}

void VirtualRing::guest_accepts(NodeId id) {
  const auto from = predecessor(id);
  if (from && nodes_[*from].guest == nullptr && end_of(*from, Line::first, false).told != id)
    attach_output(*from, id, Line::first);
}

void VirtualRing::guest_connected(NodeId id) {
  const auto to = successor(id);
  if (to && nodes_[*to].guest == nullptr) attach_input(*to, id, Line::first);
}

void VirtualRing::guest_gap(NodeId id) {
  const auto to = successor(id);
  if (to && nodes_[*to].guest == nullptr) node(*to).apply(core::input::InputGap{Line::first}, time_of(*to));
}

void VirtualRing::attach_output(NodeId id, NodeId to, Line line) {
  notice(id, line, false);
  end_of(id, line, false).told = to;
  touch(id);
  for (Observer* observer : observers_) observer->output_ready(id, true, now_);
  nodes_[id].controller->apply(core::input::OutputUp{line, to}, time_of(id));
}

void VirtualRing::output_lost(NodeId id, Line line) {
  touch(id);
  if (nodes_[id].guest != nullptr) return nodes_[id].guest->output_gone();
  nodes_[id].controller->apply(core::input::OutputLost{line}, time_of(id));
}

// ---- what a node notices late -------------------------------------------------------------

void VirtualRing::lose_end(NodeId id, Line line, bool input) {
  End& end = end_of(id, line, input);
  if (end.loses_it()) return;
  const Duration unnoticed = options_.noticing ? options_.noticing() : Duration{0};
  end.notices = now_ + unnoticed;
  if (unnoticed == Duration{0}) return notice(id, line, input);
  at(end.notices, [this, id, line, input, due = end.notices] {
    if (end_of(id, line, input).notices == due) notice(id, line, input);
  });
}

void VirtualRing::notice(NodeId id, Line line, bool input) {
  End& end = end_of(id, line, input);
  if (!end.loses_it()) return;
  end = {};
  if (input) return input_lost(id, line);
  output_lost(id, line);
  tell(id, Incident::output_replaced, line);
}

void VirtualRing::forget_ends(NodeId id) { nodes_[id].inputs = nodes_[id].outputs = {}; }

// The line out of `id` is back before either end has noticed that it was gone. @return false if one has
bool VirtualRing::revive(NodeId id, Line line) {
  Wire& out = wire_of(id, line);
  if (out.successor >= 0 || out.former < 0 || out.former != next(id, line) || out.former == id) return false;
  const auto to = static_cast<NodeId>(out.former);
  End &output = end_of(id, line, false), &input = end_of(to, line, true);
  const bool both_unaware = output.loses_it() && output.told == to && input.loses_it() && input.told == id;
  if (!both_unaware || wire_of(to, line).predecessor >= 0) return false;
  output.notices = input.notices = core::kNever;
  out.successor = to;
  wire_of(to, line).predecessor = id;
  touch(to);
  for (Observer* observer : observers_) observer->input_changes(to, line, now_);
  nodes_[to].controller->apply(core::input::InputGap{line}, time_of(to));
  return true;
}

// When both ends of a line from `id` to `to` have noticed that their last ones are gone; now, if they have.
Time VirtualRing::noticed_at(NodeId id, NodeId to, Line line) {
  Time at = now_;
  for (const End& end : {end_of(id, line, false), end_of(to, line, true)})
    if (end.loses_it()) at = std::max(at, end.notices);
  return at;
}

// ---- who is next to whom ------------------------------------------------------------------

void VirtualRing::disconnect_output(NodeId id, Line line) {
  Wire& out = wire_of(id, line);
  if (out.successor < 0) return;
  const auto to = static_cast<NodeId>(out.successor);
  ++out.epoch;
  out.former = out.successor;
  out.successor = -1;
  if (alive(id))
    lose_end(id, line, false);
  else
    tell(id, Incident::output_replaced, line);
  if (alive(to) && wire_of(to, line).predecessor == id) {
    lose_end(to, line, true);
    wire_of(to, line).predecessor = -1;
  }
}

void VirtualRing::connect(NodeId id, Line line) {
  Wire& out = wire_of(id, line);
  const int next = this->next(id, line);
  if (!alive(id) || out.cut || next < 0 || next == out.successor) return;
  const auto to = static_cast<NodeId>(next);
  if (const Time noticed = noticed_at(id, to, line); noticed > now_)
    return at(noticed, [this, id, line] { connect(id, line); });
  disconnect_output(id, line);
  notice(id, line, false);  // it has left that one by itself
  const int former = wire_of(to, line).predecessor;
  if (former >= 0 && former != id && wire_of(static_cast<NodeId>(former), line).successor == next)
    disconnect_output(static_cast<NodeId>(former), line);
  out.successor = next;
  wire_of(to, line).predecessor = id;
  input_up(to, id, line);
  if (!options_.connecting) return output_up(id, to, line);
  at(now_ + options_.connecting(), [this, id, to, line, nth = ++out.connected] {
    const Wire& wire = wire_of(id, line);
    if (alive(id) && wire.connected == nth && wire.successor == to) output_up(id, to, line);
  });
}

void VirtualRing::connect_later(NodeId id, Line line) {
  if (!options_.connecting) return connect(id, line);
  at(now_ + options_.connecting(), [this, id, line] { connect(id, line); });
}

// The neighbours close the ring without this node.
void VirtualRing::leave(NodeId id) {
  std::array<std::array<int, 2>, 2> before{};
  for (const Line line : lines()) {
    // Lines that take time may not lead to the next node yet: then somebody else's still leads here.
    auto& all = before[static_cast<std::size_t>(line)] = {this->before(id, line), wire_of(id, line).predecessor};
    for (const int b : all)
      if (b >= 0 && b != id && wire_of(static_cast<NodeId>(b), line).successor == id)
        disconnect_output(static_cast<NodeId>(b), line);
    disconnect_output(id, line);
    wire_of(id, line).predecessor = -1;
  }
  forget_ends(id);
  wakes_.set(id, kNever);
  nodes_[id].alive = nodes_[id].paused = false;
  nodes_[id].waiting.clear();
  for (const Line line : lines()) {
    const auto& [b, other] = before[static_cast<std::size_t>(line)];
    if (b >= 0 && b != id) connect_later(static_cast<NodeId>(b), line);
    if (other >= 0 && other != id && other != b) connect_later(static_cast<NodeId>(other), line);
  }
}

// The neighbours close the ring with this node in it.
void VirtualRing::enter(NodeId id) {
  nodes_[id].alive = true;
  for (const Line line : lines()) {
    const int before = this->before(id, line);
    if (before != id) connect_later(static_cast<NodeId>(before), line);
    connect_later(id, line);
  }
}

void VirtualRing::tell(NodeId id, Incident incident, Line line) {
  for (Observer* observer : observers_) observer->incident(id, incident, now_, line);
}

void VirtualRing::kill(NodeId id) {
  if (!alive(id)) return;
  leave(id);
  tell(id, Incident::killed);
}

void VirtualRing::start(NodeId id) {
  if (alive(id)) return;
  Node& n = nodes_[id];
  ++n.starts;
  let_clock_go_on(id);
  const auto former = make_node(id);  // an observer may let go of it when it hears of the next one
  n.controller->set_cpu_present(true);
  tell(id, Incident::started);
  enter(id);
}

void VirtualRing::freeze(NodeId id, bool clock_stands) {
  if (!alive(id)) return;
  leave(id);
  if (clock_stands) {
    nodes_[id].stands_since = now_;
    clocks_differ_ = true;
  }
  tell(id, Incident::frozen);
}

void VirtualRing::let_clock_go_on(NodeId id) {
  if (nodes_[id].stands_since != kNever) set_ahead(id, ahead(id));
}

void VirtualRing::skip_time(NodeId id, Duration by) {
  if (by == Duration{0}) return;
  const bool stands = nodes_[id].stands_since != kNever;
  set_ahead(id, ahead(id) + by);
  if (stands) nodes_[id].stands_since = now_;
  touch(id);
}

void VirtualRing::set_ahead(NodeId id, Duration ahead) {
  Node& n = nodes_[id];
  n.stands_since = kNever;
  clocks_differ_ = true;
  n.clock_steps.push_back({now_ + ahead, ahead});
  if (n.clock_steps.size() > kClockSteps) n.clock_steps.erase(n.clock_steps.begin());
}

Time VirtualRing::before_steps(NodeId id, Time of_node) const {
  const std::vector<ClockStep>& steps = nodes_[id].clock_steps;
  if (of_node >= steps.back().since) return of_node - ahead(id);
  const auto next = std::find_if(steps.begin(), steps.end(), [&](const ClockStep& s) { return s.since > of_node; });
  const Duration ahead = next == steps.begin() ? Duration{0} : std::prev(next)->ahead;
  return of_node - ahead;
}

void VirtualRing::tell_by_ring_clock(NodeId id, core::Event& event) const {
  if (nodes_[id].clock_steps.empty()) return;
  if (auto* end = std::get_if<core::SendEnded>(&event.what))
    end->round_trip = in_ring(id, event.at) - in_ring(id, event.at - end->round_trip);
  event.at = in_ring(id, event.at);
}

void VirtualRing::thaw(NodeId id) {
  if (alive(id)) return;
  let_clock_go_on(id);
  tell(id, Incident::thawed);
  for (const Line line : lines()) {
    input_lost(id, line);
    output_lost(id, line);
  }
  enter(id);
}

void VirtualRing::pause(NodeId id) {
  if (!alive(id) || paused(id)) return;
  nodes_[id].paused = true;
  wakes_.set(id, kNever);
  tell(id, Incident::late_slice);
}

// What has waited is late, as from a line that held it back. What the node has noticed of its lines meanwhile comes
// first.
void VirtualRing::resume(NodeId id) {
  if (!paused(id)) return;
  nodes_[id].paused = false;
  tell(id, Incident::resumed);
  if (nodes_[id].guest == nullptr && nodes_[id].controller->has_output(time_of(id))) give_out(id);
  std::vector<DelayLine::Arrival> waiting;
  waiting.swap(nodes_[id].waiting);
  for (const DelayLine::Arrival& arrival : waiting) deliver(arrival);
  touch(id);
}

void VirtualRing::set_output_ready(NodeId id, bool ready) {
  tell(id, Incident::late_slice);
  for (Observer* observer : observers_) observer->output_ready(id, ready, now_);
  for (const Line line : lines()) node(id).set_output_ready(line, ready);
}

void VirtualRing::part(const core::RingOrder& these) {
  for (Observer* observer : observers_) observer->parted(these, now_);
  for (const NodeId id : order()) nodes_[id].parted = core::is_in(these, id);
  for (const NodeId id : order())
    for (const Line line : lines()) {
      const int successor = wire_of(id, line).successor;
      if (!alive(id) || next(id, line) == successor) continue;
      if (successor >= 0 && !reaches(id, static_cast<NodeId>(successor))) {
        tell(id, Incident::cut, line);
        disconnect_output(id, line);
      }
      connect_later(id, line);
    }
}

void VirtualRing::cut(NodeId id, Line line) {
  Wire& out = wire_of(id, line);
  if (out.cut) return;
  tell(id, Incident::cut, line);
  out.cut = true;
  if (options_.noticing) return disconnect_output(id, line);
  ++out.epoch;  // what is under way is gone
  if (out.successor >= 0) input_lost(static_cast<NodeId>(out.successor), line);
}

void VirtualRing::heal(NodeId id, Line line) {
  Wire& out = wire_of(id, line);
  if (!out.cut) return;
  tell(id, Incident::healed, line);
  out.cut = false;
  ++out.epoch;
  if (options_.noticing && revive(id, line)) return;
  if (out.successor < 0 || out.successor != next(id, line)) return connect(id, line);
  input_up(static_cast<NodeId>(out.successor), id, line);
}

void VirtualRing::cut_cable(NodeId id) {
  const NodeId after = core::node_after(order(), id, 1);
  cut(id);
  cut(after, Line::second);
  if (wire_of(id).successor == after && alive(id)) disconnect_output(id, Line::first);
  if (wire_of(after, Line::second).successor == id && alive(after)) disconnect_output(after, Line::second);
}

void VirtualRing::heal_cable(NodeId id) {
  heal(id);
  heal(core::node_after(order(), id, 1), Line::second);
}

void step_clocks(VirtualRing& ring, const fault::Fault& fault) {
  for (const NodeId id : fault.nodes) {
    ring.step_wall_clock(id, fault.forward - fault.back);
    ring.skip_time(id, fault.monotonic);
  }
}

}  // namespace limb_ring::sim
