#include "sim/output_checker.h"

#include <algorithm>

namespace limb_ring::sim {

using core::NodeState;
using wire::PacketFields;
using wire::SliceKind;

OutputChecker::OutputChecker(RingRecord& record) : record_(record), outgoing_(record.ring.size()) {}

void OutputChecker::check_header(NodeId node, const PacketHeader& header) {
  const bool own_again = header.source == node && header.hop != 0;
  const bool gone_round = header.hop >= record_.ring.order().size();
  if (!own_again && !gone_round) return;
  const std::string what = "a packet of node " + std::to_string(header.source) + " with HOP " +
                           std::to_string(header.hop) + " left node " + std::to_string(node);
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
    record_.complain(Promise::no_circling, "a packet of node " + std::to_string(header.source) +
                                               " goes on through node " + std::to_string(node) +
                                               ", long after its source was gone");
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
    n.history.said_hello = record_.said_hello = record_.ring.now();
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
