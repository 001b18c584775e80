#include "sim/ring_record.h"

#include <algorithm>

namespace limb_ring::sim {

NodeRecord::NodeRecord(const core::Settings& of_node, Ledger& ledger, const Complain& complain)
    : settings(of_node),
      forwarding(settings.id, settings.byte_time_out, settings.byte_time_in, complain),
      buffers(settings.id, ledger, complain),
      receiver(settings),
      pins(settings.id, complain) {}

RingRecord::RingRecord(VirtualRing& of_ring)
    : ring(of_ring),
      on_complaint([this](Promise promise, Words what) { complain(promise, std::move(what)); }),
      ledger(ring.size(), ring.settings(ring.order()[0]).fold_back, on_complaint) {
  for (unsigned id = 0; id < ring.size(); ++id)
    nodes.push_back(std::make_unique<NodeRecord>(ring.settings(static_cast<NodeId>(id)), ledger, on_complaint));
  for (const auto& node : nodes) settling = std::max(settling, 4 * node->settings.send_timeout());
}

bool RingRecord::has_news(NodeId node, Time now) const {
  const NodeRecord& n = at(node);
  return n.news_at + told_within(n.settings) >= now;
}

Time RingRecord::last_bit(NodeId node, std::size_t tail_size, Time now) const {
  return now + at(node).settings.byte_time_in * static_cast<std::int64_t>(tail_size);
}

void RingRecord::complain(Promise promise, Words what) {
  if (!violation) violation = Violation{promise, ring.now(), std::move(what)};
}

using core::NodeState;

ResultJudge ResultChecker::judge_of(NodeId node, const Sent& sent) const {
  const NodeRecord& n = record_.at(node);
  return {sent, n.settings, n.history, record_.was_broken};
}

void ResultChecker::ends(NodeId node, const core::SendEnded& end, Time at_end) {
  NodeRecord& n = record_.at(node);
  const bool paced = end.outcome == core::Outcome::unconfirmed;  // as it left. (protocol.md section 8.4)
  const core::Duration pace = paced ? n.settings.open_chain_interrupt_pace() : core::Duration{0};
  if (end.interrupt) n.interrupt_free = std::max(n.interrupt_free, at_end + pace);  // others are cancelled meanwhile
  record_.ledger.settle(at_end);
  judge_unexplained(node);
  // If tries fail or numbers are used up, copies are under way, and a hello may come between them.
  if (end.tries > 1 || end.outcome == core::Outcome::lost || end.outcome == core::Outcome::no_such_node)
    record_.disturbed(at_end);
  const Sent* sent = record_.ledger.end(node, end, at_end);
  if (!sent) return;
  std::vector<Unexplained>& unexplained = unexplained_[node];
  const Words ended = sent->name() + " ended " + core::to_string(end.outcome);
  if (const char* objection = judge_of(node, *sent).objection())
    record_.complain(Promise::true_result, ended + objection);
  if (end.outcome == core::Outcome::cancelled && n.history.cancelled != at_end)
    unexplained.push_back({record_.ring.now(), end.outcome, ended + ", and nobody had cancelled it"});
  const bool was_in_chain =
      n.history.open_chain_until != Time{} && at_end - n.history.open_chain_until <= told_within(n.settings);
  if (end.outcome == core::Outcome::unconfirmed && n.history.state != NodeState::open_chain && !was_in_chain)
    unexplained.push_back({record_.ring.now(), end.outcome, ended + ", and its node is in no open chain"});
  const bool was_in_ring = sent->asked_in_ring && n.history.state_at < sent->asked;
  if (end.reject == core::Reject::not_in_ring && was_in_ring)
    unexplained.push_back({record_.ring.now(), end.outcome, ended + ", and its node was in a ring"});
}

// A node that starts over cancels its sends, and rejects new ones until it is in a ring again.
void ResultChecker::state_changes(NodeId node, NodeState state) {
  const auto explains = [&](core::Outcome outcome) {
    const auto of_it = [&](const Unexplained& result) { return result.outcome == outcome; };
    auto& all = unexplained_[node];
    all.erase(std::remove_if(all.begin(), all.end(), of_it), all.end());
  };
  if (state == NodeState::open_chain) explains(core::Outcome::unconfirmed);
  if (!may_send(state)) explains(core::Outcome::rejected);
  if (state == NodeState::starting || state == NodeState::duplicate_id) explains(core::Outcome::cancelled);
}

// The state that explains a result may be shown after it: a node that starts over ends its sends first.
void ResultChecker::judge_unexplained(NodeId node) {
  const core::Duration tail = told_within(record_.at(node).settings);
  for (const Unexplained& result : unexplained_[node])
    if (result.when + tail < record_.ring.now()) record_.complain(Promise::true_result, result.what);
}

void ResultChecker::judge_open(NodeId node, bool all) {
  record_.ledger.each_open(node, [&](const Sent& sent) {
    if (all || judge_of(node, sent).due() < record_.ring.now())
      record_.complain(Promise::one_result, sent.name() + " has not ended");
  });
}

using wire::PacketFields;
using wire::SliceKind;

OutputChecker::OutputChecker(RingRecord& record) : record_(record), outgoing_(record.ring.size()) {}

void OutputChecker::check_header(NodeId node, const PacketHeader& header) {
  const bool own_again = header.source == node && header.hop != 0;
  const bool gone_round = header.hop >= record_.ring.order().size();
  if (!own_again && !gone_round) return;
  const Words what = "a packet of " + node_words(header.source) + " with HOP " + std::to_string(header.hop) + " left " +
                     node_words(node);
  if (own_again) record_.complain(Promise::no_circling, what + ", its source");
  if (gone_round) record_.complain(Promise::no_circling, what + ": it has gone round");
}

// The packets of a node that is gone have passed after a time-out and a lap, counted from when a line released them if
// that was later.
void OutputChecker::check_source(NodeId node, const PacketHeader& header, Time now) {
  if (header.source >= record_.ring.size()) return;
  const auto& away = record_.at(header.source).away_since;
  const core::Settings& settings = record_.at(node).settings;
  if (away && now - std::max(*away, record_.released) > settings.send_timeout() + settings.worst_lap())
    record_.complain(Promise::no_circling, "a packet of " + node_words(header.source) + " goes on through " +
                                               node_words(node) + ", long after its source was gone");
}

void OutputChecker::leaves(NodeId node, const wire::Slice& slice, Time now) {
  Outgoing& out = outgoing_[node];
  const bool begins = slice.kind == SliceKind::start || slice.kind == SliceKind::whole;
  if (begins) begins_to_leave(node, slice, now);
  wire::ByteView own;
  if (out.own) own = out.collector.put(slice, now);
  if (slice.kind == SliceKind::whole || slice.kind == SliceKind::end) data_leaves(node, slice, own, now);
  if (slice.kind == SliceKind::interrupt) interrupt_leaves(node, slice, now);
}

void OutputChecker::begins_to_leave(NodeId node, const wire::Slice& slice, Time now) {
  Outgoing& out = outgoing_[node];
  out.header = PacketHeader::of(slice.bytes);
  out.own = out.header.source == node;
  out.since = now;
  check_header(node, out.header);
  if (!out.own) return;
  NodeRecord& n = record_.at(node);
  n.control = {};  // what is out now is this one
  if (n.receiver.joined() != Tristate::yes) hello_begins(n, now);
  record_.ledger.try_begins(node, out.header.code, now);
}

// The first packet is the hello. In an open chain it counts as home as soon as it begins to leave. (protocol.md
// section 4.8)
void OutputChecker::hello_begins(NodeRecord& n, Time now) {
  n.hello_begun = now;
  if (n.history.state != NodeState::open_chain || n.receiver.joined() != Tristate::no) return;
  // What begins in the instant of the start may be of the life before.
  now > n.began ? n.receiver.join() : n.receiver.set_joined(Tristate::unknown);
}

void OutputChecker::data_leaves(NodeId node, const wire::Slice& end, wire::ByteView own, Time now) {
  const Outgoing& out = outgoing_[node];
  if (!out.own) {
    const bool good = record_.at(node).forwarding.went(out.header, PacketTrailer::of(end.bytes), now);
    if (good) check_source(node, out.header, now);
  } else if (!own.empty()) {
    own_data_leaves(node, PacketFields{own});
  }
}

void OutputChecker::own_data_leaves(NodeId node, const PacketFields& packet) {
  NodeRecord& n = record_.at(node);
  const bool control = wire::is_control(packet);
  const auto hello = control ? wire::decode_hello(packet.data()) : std::nullopt;
  if (hello) {
    n.hello_left = true;
    n.receiver.says_hello(hello->boot);
  }
  // Nothing else is sent before the hello is home. (protocol.md section 4.8)
  n.hello_out = hello.has_value();
  const bool joins = hello ? n.history.state == NodeState::open_chain : n.receiver.joined() != Tristate::yes;
  // What began in the instant of the start may be of the life before.
  if (joins && outgoing_[node].since > n.began)
    n.receiver.join();
  else if (joins && hello && n.receiver.joined() == Tristate::no)
    n.receiver.set_joined(Tristate::unknown);
  if (control) {
    n.control = {packet.code_byte(), packet.crc(), hello.has_value(), false, record_.ring.now()};
    return record_.ledger.try_is_control(node);
  }
  record_.ledger.depart(node, packet.code(),
                        {packet.destination(), wire::priority_of(packet.last()), wire::channel_of(packet.last()),
                         packet.data().size, packet.crc(), wire::crc32(packet.data())},
                        outgoing_[node].since);
}

void OutputChecker::interrupt_leaves(NodeId node, const wire::Slice& slice, Time now) {
  const PacketHeader header = PacketHeader::of(slice.bytes);
  const PacketTrailer tail = PacketTrailer::of(slice.bytes);
  check_header(node, header);
  NodeRecord& n = record_.at(node);
  if (header.source != node) {
    if (n.forwarding.went(header, tail, now)) check_source(node, header, now);
  } else {
    const bool free = !record_.ledger.awaits(node, true);
    record_.ledger.try_begins(node, header.code, now);
    const Sent* sent = record_.ledger.depart(node, header.code, {tail.destination, 4, tail.last, 0, tail.crc, 0}, now);
    if (sent && sent->tries == 1 && free && !n.hello_out && sent->asked >= record_.settled_from &&
        n.history.state != NodeState::open_chain)
      n.forwarding.own_interrupt_went(std::max({sent->asked, n.interrupt_free, n.history.state_at, n.control_home}),
                                      now);
  }
  n.forwarding.count_interrupt(now);
}

}  // namespace limb_ring::sim
