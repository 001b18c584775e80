#include "sim/invariants.h"

#include <algorithm>

namespace limb_ring::sim {

using core::Counters;
using wire::SliceKind;

namespace {

bool is_control(const PacketTrailer& tail) {
  return wire::channel_of(tail.last) == static_cast<std::uint8_t>(wire::Channel::control);
}

}  // namespace

Invariants::Invariants(VirtualRing& ring)
    : ring_(ring),
      complain_([this](Promise promise, std::string what) { complain(promise, std::move(what)); }),
      ledger_(ring.size(), complain_) {
  for (unsigned id = 0; id < ring.size(); ++id)
    nodes_.push_back(std::make_unique<Node>(ring.settings(static_cast<NodeId>(id)), ledger_, complain_));
  ring.add_observer(*this);
}

void Invariants::complain(Promise promise, std::string what) {
  if (!violation_) violation_ = Violation{promise, ring_.now(), std::move(what)};
}

void Invariants::finish() {
  std::vector<bool> alive;
  for (unsigned id = 0; id < ring_.size(); ++id) alive.push_back(ring_.alive(static_cast<NodeId>(id)));
  ledger_.finish(alive);
}

// ---- CPUs -----------------------------------------------------------------------------------

void Invariants::asked(NodeId node, const core::SendRequest& request, Time now) { ledger_.ask(node, request, now); }

void Invariants::asked(NodeId node, const core::InterruptRequest& request, Time now) {
  ledger_.ask(node, request, now);
}

void Invariants::event(NodeId node, const core::Event& event) {
  if (const auto* state = std::get_if<core::StateChanged>(&event.what))
    if (state->after == core::NodeState::starting) ledger_.forgets_interrupts(node);
  const auto* end = std::get_if<core::SendEnded>(&event.what);
  if (!end) return;
  if (end->interrupt) at(node).interrupt_free = event.at;
  // If tries fail or numbers are used up, copies are under way, and a hello may come between them.
  ledger_.settle(event.at);
  if (end->tries > 1 || end->outcome == core::Outcome::lost || end->outcome == core::Outcome::no_such_node)
    faults_ = true;
  ledger_.end(node, *end, event.at);
}

void Invariants::packet(NodeId node, const core::ReceivedPacket& packet) { at(node).buffers.read(packet, ring_.now()); }

// ---- out of a node --------------------------------------------------------------------------

void Invariants::check_head(NodeId node, const PacketHeader& head) {
  const std::string what = "a packet of node " + std::to_string(head.source) + " with HOP " + std::to_string(head.hop) +
                           " left node " + std::to_string(node);
  if (head.source == node && head.hop != 0) complain(Promise::no_circling, what + ", its source");
  if (head.hop >= ring_.size()) complain(Promise::no_circling, what + ": it has gone round");
}

// The packets of a node that is gone have passed after one time-out; or one time-out after a line released them.
void Invariants::check_source(NodeId node, const PacketHeader& head, Time now) {
  if (head.source >= ring_.size()) return;
  const auto& away = at(head.source).away_since;
  const core::Settings& settings = ring_.settings(node);
  if (away && now - std::max(*away, late_) > settings.send_timeout() + settings.worst_lap())
    complain(Promise::no_circling, "a packet of node " + std::to_string(head.source) + " goes on through node " +
                                       std::to_string(node) + ", long after its source was gone");
}

void Invariants::leaves(NodeId node, const wire::Slice& slice, Time now) {
  if (slice.kind == SliceKind::start || slice.kind == SliceKind::whole) {
    at(node).going = PacketHeader::of(slice.bytes);
    at(node).going_since = now;
    at(node).going_size = 0;
    if (at(node).going.source == node) ledger_.try_begins(node, at(node).going.code, now);
    check_head(node, at(node).going);
  }
  if (slice.kind != SliceKind::interrupt) at(node).going_size += slice.bytes.size;
  if (whole_or_end(slice)) data_leaves(node, slice, now);
  if (slice.kind == SliceKind::interrupt) interrupt_leaves(node, slice, now);
}

void Invariants::data_leaves(NodeId node, const wire::Slice& slice, Time now) {
  const PacketHeader& head = at(node).going;
  const PacketTrailer tail = PacketTrailer::of(slice.bytes);
  if (head.source != node) return at(node).forwarding.went(head, tail, now);
  if (is_control(tail)) return ledger_.try_is_control(node);
  const std::size_t size = at(node).going_size - wire::kOverhead;
  ledger_.depart(node, head.code,
                 {tail.destination, wire::priority_of(tail.last), wire::channel_of(tail.last), size, tail.crc},
                 at(node).going_since);
}

void Invariants::interrupt_leaves(NodeId node, const wire::Slice& slice, Time now) {
  const PacketHeader head = PacketHeader::of(slice.bytes);
  const PacketTrailer tail = PacketTrailer::of(slice.bytes);
  check_head(node, head);
  Node& n = at(node);
  if (head.source != node) {
    n.forwarding.went(head, tail, now);
  } else {
    ledger_.try_begins(node, head.code, now);
    const Sent* sent = ledger_.depart(node, head.code, {tail.destination, 4, tail.last, 0, tail.crc}, now);
    if (sent && !faults_) n.forwarding.own_interrupt_went(std::max(sent->asked, n.interrupt_free), now);
  }
  n.forwarding.count_interrupt(now);
}

// ---- into a node ----------------------------------------------------------------------------

Invariants::Before Invariants::count(NodeId node, wire::Priority priority) const {
  const Counters& c = ring_.counters(node);
  const std::size_t used = ring_.received_waiting(node, priority);
  const std::size_t buffers = ring_.settings(node).receive_buffers;
  return {c.received_data + c.received_control,
          c.earlier_incarnation + c.refused_joining + c.refused_cpu_absent + c.refused_no_buffer + c.refused_unwired,
          c.duplicates,
          c.crc_errors + c.malformed_packets,
          c.pins_pulled,
          c.returned_data + c.returned_interrupts,
          c.insertion_buffer_full + c.interrupt_buffer_full + c.dropped_no_output + c.orphans_hop + c.orphans_bypassed +
              c.orphans_cut_off,
          c.stray_slices + c.oversize_packets,
          std::min<std::size_t>(buffers - std::min(used, buffers), wire::kFbcMax)};
}

void Invariants::arrives(NodeId node, const wire::Slice& slice, Time) {
  if (slice.kind == SliceKind::start || slice.kind == SliceKind::whole) {
    at(node).coming = PacketHeader::of(slice.bytes);
    at(node).coming_size = 0;
    at(node).passes_on = wire::header_valid(slice.bytes, false);
  }
  if (slice.kind != SliceKind::interrupt) at(node).coming_size += slice.bytes.size;
  const bool ends = whole_or_end(slice);
  const wire::Priority priority = ends ? wire::priority_of(PacketTrailer::of(slice.bytes).last) : wire::Priority{};
  at(node).before = count(node, priority);
  // What waited for the output when it turned back was dropped.
  if (at(node).no_output != ring_.counters(node).dropped_no_output) at(node).forwarding.clear();
}

void Invariants::has_arrived(NodeId node, const wire::Slice& slice, Time now) {
  const Before after = count(node, wire::Priority{});
  at(node).no_output = ring_.counters(node).dropped_no_output;
  if (slice.kind == SliceKind::abort || after.stray != at(node).before.stray) at(node).coming.reset();
  if (whole_or_end(slice)) data_has_arrived(node, slice, after, now);
  if (slice.kind == SliceKind::interrupt) interrupt_has_arrived(node, slice, after, now);
  if (slice.kind == SliceKind::start)
    at(node).passes_on = after.dropped == at(node).before.dropped && wire::header_valid(slice.bytes, false);
  check_insertion(node);
}

void Invariants::data_has_arrived(NodeId node, const wire::Slice& slice, const Before& after, Time now) {
  const std::size_t size = at(node).coming_size;
  if (!at(node).coming || size < wire::kMinDataPacketSize || size > wire::kMaxDataPacketSize) return;
  const PacketHeader head = *at(node).coming;
  at(node).coming.reset();
  const PacketTrailer tail = PacketTrailer::of(slice.bytes);
  const Before& before = at(node).before;
  const std::uint8_t priority = wire::priority_of(tail.last);
  const bool taken = after.taken != before.taken;
  if (taken && after.bad != before.bad)
    complain(Promise::undamaged, "node " + std::to_string(node) + " took a packet with a wrong CRC");
  Sent* sent = ledger_.on_line(head.source, head.code, tail.destination, tail.crc_at_source(head, size));
  const int fbc = due_fbc(node, sent, tail, after);
  const Time at_end = last_bit(node, (size - wire::kOverhead) % 4 + wire::kTrailerSize + wire::kCrcSize, now);
  if (taken && !is_control(tail)) {
    ledger_.take(sent, head.source, node, priority);
    at(node).buffers.put(sent, head.source, priority, at_end);
  }
  if (after.refused != before.refused) ledger_.refuse(sent, node);
  const bool goes_on = at(node).passes_on && after.dropped == before.dropped;
  if (after.bad == before.bad && goes_on) check_source(node, head, now);
  if (after.returned != before.returned) ledger_.come_home(sent, fbc, at_end);
  if (head.source != node && goes_on) at(node).forwarding.came(head, tail.destination, fbc, now);
}

// min(FBC, free buffers before), 0 where refused; the same verdict, at least 1 where it was taken,
// for what was decided before. (protocol.md sections 3.5 and 4.10)
int Invariants::due_fbc(NodeId node, const Sent* sent, const PacketTrailer& tail, const Before& after) const {
  const Before& before = nodes_[node]->before;
  const std::size_t free = is_control(tail) ? wire::kFbcMax : before.free;
  const auto least = [&](std::size_t value) { return static_cast<int>(std::min<std::size_t>(tail.fbc, value)); };
  if (after.refused != before.refused) return 0;
  if (after.taken != before.taken) return least(free);
  if (after.repeated == before.repeated) return tail.fbc;
  if (is_control(tail)) return least(free);
  if (!sent) return ForwardingChecker::kAnyFbc;
  if (sent->taken_last_by(node)) return least(std::max<std::size_t>(1, free));
  // Two parts of a folded ring have grown together: the verdict may be on an older number, and its source knows.
  return ring_.settings(node).fold_back ? ForwardingChecker::kAnyFbc : 0;
}

void Invariants::interrupt_has_arrived(NodeId node, const wire::Slice& slice, const Before& after, Time now) {
  const PacketHeader head = PacketHeader::of(slice.bytes);
  const PacketTrailer tail = PacketTrailer::of(slice.bytes);
  const Before& before = at(node).before;
  const bool pulled = after.pulled != before.pulled;
  Sent* sent =
      ledger_.on_line(head.source, head.code, tail.destination, tail.crc_at_source(head, wire::kInterruptPacketSize));
  if (after.bad == before.bad && after.dropped == before.dropped) check_source(node, head, now);
  if (pulled) ledger_.take(sent, head.source, node, 4);
  if (after.returned != before.returned) {
    at(node).interrupt_free = last_bit(node, wire::kInterruptPacketSize, now);
    ledger_.come_home(sent, tail.fbc, at(node).interrupt_free);
  }
  if (head.source == node) return;
  int fbc = tail.fbc;
  if (pulled) fbc = std::min(fbc, 1);
  if (after.refused != before.refused) fbc = 0;
  if (after.repeated != before.repeated) fbc = ForwardingChecker::kAnyFbc;
  if (after.dropped == before.dropped && wire::header_valid(slice.bytes, true))
    at(node).forwarding.came(head, tail.destination, fbc, now);
}

// A slice comes as its last bytes begin.
Time Invariants::last_bit(NodeId node, std::size_t tail_size, Time now) const {
  return now + ring_.settings(node).byte_time_in * static_cast<std::int64_t>(tail_size);
}

// While nothing is lost a node whose output is no slower is behind its input by its own DATP and INTP;
// what has left of the DATP on the line counts until its end is through. (protocol.md section 2.5)
void Invariants::check_insertion(NodeId node) {
  constexpr std::size_t kNormal = 2 * wire::kMaxDataPacketSize + wire::kInterruptPacketSize;
  const std::size_t bytes = ring_.insertion_buffer(node).bytes();
  const core::Settings& settings = ring_.settings(node);
  const bool normal = !faults_ && settings.byte_time_out <= settings.byte_time_in;
  const std::size_t most = normal ? kNormal : settings.insertion_buffer * wire::kMaxDataPacketSize;
  if (bytes > most)
    complain(Promise::insertion_bound, std::to_string(bytes) + " bytes wait in node " + std::to_string(node) + ", " +
                                           std::to_string(most) + " may");
}

// ---- faults ---------------------------------------------------------------------------------

void Invariants::incident(NodeId node, Incident incident, Time now, Line) {
  faults_ = true;
  if (incident == Incident::late_slice) {
    late_ = now;
    ledger_.line_let_go(now);
  }
  Node& n = at(node);
  if (incident == Incident::killed || incident == Incident::frozen) n.away_since = now;
  if (incident == Incident::started || incident == Incident::thawed) n.away_since.reset();
  if (incident == Incident::started) ledger_.start(node);
  if (incident == Incident::started || incident == Incident::cpu_reset) n.buffers.flush();
  if (incident == Incident::cpu_reset || incident == Incident::cancelled) ledger_.cancel(node, now);
  // The buffers of a line that is replaced are emptied, unless what waits goes on over the second line.
  const bool emptied = incident == Incident::output_replaced && !ring_.settings(node).fold_back;
  if (incident == Incident::started || emptied) n.forwarding.clear();
}

}  // namespace limb_ring::sim
