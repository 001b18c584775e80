
#include "sim/invariants.h"

namespace limb_ring::sim {

using core::NodeState;

Invariants::Invariants(VirtualRing& ring) : record_(ring), outputs_(record_), inputs_(record_), results_(record_) {
  ring.add_observer(*this);
}

bool Invariants::all_ended() const {
  std::size_t open = 0;
  for (const NodeId node : record_.ring.order())
    if (record_.ring.alive(node)) record_.ledger.each_open(node, [&](const Sent&) { ++open; });
  return open == 0;
}

void Invariants::finish() {
  record_.ledger.settle(core::kNever);
  for (unsigned id = 0; id < record_.ring.size(); ++id) {
    const auto node = static_cast<NodeId>(id);
    if (!record_.ring.alive(node)) continue;
    record_.at(node).pins.judge(record_.ring.now());
    results_.judge_open(node, true);
    results_.judge_unexplained(node);
  }
}

// ---- lines ----------------------------------------------------------------------------------

void Invariants::leaves(NodeId node, const wire::Slice& slice, Time now) { outputs_.leaves(node, slice, now); }

void Invariants::arrives(NodeId node, const wire::Slice& slice, Time now) { inputs_.arrives(node, slice, now); }

void Invariants::word_arrives(NodeId node, wire::FoldWord word, Line line, Time now) {
  inputs_.word_arrives(node, word, line, now);
}

void Invariants::input_changes(NodeId node, Line line, Time now) {
  inputs_.input_changes(node, line, now);
  NodeRecord& n = record_.at(node);
  n.receiver.input_changes(record_.by_clock_of(node, now));
  n.line_may_have_changed();
  n.input_changed_at = now;
  if (n.output_lost_at == now) n.lines_crossed_at = now;
}

void Invariants::output_ready(NodeId node, bool, Time now) {
  record_.at(node).forwarding.released(now);
  record_.at(node).line_may_have_changed();
}

// ---- CPUs -----------------------------------------------------------------------------------

void Invariants::asked(NodeId node, const core::SendRequest& request, Time now) {
  results_.judge_open(node, false);
  record_.ledger.ask(node, request, may_send(record_.at(node).history.state), now);
}

void Invariants::asked(NodeId node, const core::InterruptRequest& request, Time now) {
  results_.judge_open(node, false);
  record_.ledger.ask(node, request, may_send(record_.at(node).history.state), now);
}

void Invariants::cpu_present(NodeId node, bool present, Time) { record_.at(node).receiver.set_cpu_present(present); }

void Invariants::packet(NodeId node, const core::ReceivedPacket& packet) {
  record_.at(node).buffers.read(packet, record_.ring.now());
}

// ---- what a node says of itself -------------------------------------------------------------

void Invariants::event(NodeId node, const core::Event& event) {
  if (const auto* state = std::get_if<core::StateChanged>(&event.what)) state_changes(node, state->after);
  if (const auto* pin = std::get_if<core::PinPulled>(&event.what)) record_.at(node).pins.pulled(*pin, event.at);
  if (const auto* end = std::get_if<core::SendEnded>(&event.what)) results_.ends(node, *end, event.at);
}

// A hello that has begun to leave counts as home in an open chain. (protocol.md section 4.8)
void Invariants::state_changes(NodeId node, NodeState state) {
  NodeRecord& n = record_.at(node);
  const NodeState before = n.history.state;
  if (before == NodeState::open_chain) n.history.open_chain_until = record_.ring.now();
  n.history.state = state;
  n.history.state_at = record_.ring.now();
  results_.state_changes(node, state);
  if (state == NodeState::open_chain && n.hello_leaves() && n.receiver.joined() != Tristate::yes)
    n.receiver.set_joined(Tristate::unknown);
  if (state != NodeState::starting && state != NodeState::duplicate_id) return;
  // A hello may leave in the same instant; the observer is told of it before it is told of the state.
  n.began = record_.ring.now();
  n.hello_left = n.control.hello && n.control.left == n.began;
  if (!n.hello_left) n.control = {};
  // A joining node whose hello ends lost while a line is down only waits for it. (protocol.md section 8.1)
  if (state == NodeState::starting && before == NodeState::joining)
    n.receiver.may_start_over();
  else if (state == NodeState::starting)
    starts_over(node);
  else
    n.receiver.begin_incarnation();
  record_.ledger.waits_for_nothing(node);
}

void Invariants::starts_over(NodeId node) {
  NodeRecord& n = record_.at(node);
  n.receiver.start_over(n.lines_crossed_at == n.began, record_.by_clock_of(node, n.began));
  record_.ledger.forgets(node,
                         n.settings.falls_into_parts() ? n.began - n.settings.send_timeout() : n.input_changed_at);
}

// ---- faults ---------------------------------------------------------------------------------

void Invariants::incident(NodeId node, Incident incident, Time now, Line) {
  record_.disturbed(now);
  if (incident != Incident::cpu_reset && incident != Incident::cancelled) record_.was_broken = true;
  if (incident == Incident::late_slice || incident == Incident::resumed) {
    record_.released = now;
    record_.ledger.line_released(now);
  }
  NodeRecord& n = record_.at(node);
  if (incident == Incident::resumed) n.forwarding.released(now);
  if (incident == Incident::killed || incident == Incident::frozen) n.away_since = now;
  if (incident == Incident::frozen) n.clock_stands = record_.ring.clock_stands(node);
  if (incident == Incident::frozen && n.clock_stands) record_.ledger.clock_stood(node);
  if (incident == Incident::thawed && n.clock_stands) n.clock_stood(*n.away_since, now);
  if (incident == Incident::started || incident == Incident::thawed) n.away_since.reset();
  if (incident == Incident::thawed) n.history.thawed = now;
  if (incident == Incident::output_replaced) {
    n.output_lost_at = now;
    n.line_may_have_changed();
  }
  if (incident == Incident::killed) results_.judge_open(node, false);
  if (incident == Incident::started) starts(node, now);
  if (incident == Incident::started || incident == Incident::cpu_reset) n.buffers.flush();
  if (incident == Incident::cpu_reset || incident == Incident::cancelled) {
    record_.ledger.cancel(node, now);
    n.history.cancelled = now;
  }
  // The buffers of a line that is replaced are emptied, unless what waits goes on over the second line.
  const bool emptied = incident == Incident::output_replaced && !n.settings.fold_back;
  if (incident == Incident::started || emptied) n.forwarding.clear();
}

void Invariants::starts(NodeId node, Time now) {
  NodeRecord& n = record_.at(node);
  record_.ledger.start(node, now);
  n.receiver = ReceiverModel(n.settings);
  n.history.state = NodeState::starting;
  n.history.state_at = now;
  n.history.cancelled = core::kNever;
  n.began = now;
  n.hello_begun.reset();
  n.hello_left = false;
  n.control = {};
  n.pins.clear();
  results_.start(node);
  inputs_.start(node);
}

}  // namespace limb_ring::sim
