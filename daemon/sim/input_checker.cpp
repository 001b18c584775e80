#include "sim/input_checker.h"

#include <algorithm>

namespace limb_ring::sim {

using wire::PacketFields;
using wire::SliceKind;
using Answer = ReceiverModel::Answer;

namespace {

/// The longest pause between two slices of a DATP. (protocol.md section 7.4)
core::Duration stall_of(const core::Settings& settings) { return settings.stall + 2048 * settings.byte_time_in; }

/// If lines differ, what a slow one has held up comes all at once further on, and the bound is not promised.
bool lines_differ(const core::Settings& settings) {
  const core::Duration each =
      settings.byte_time_out * static_cast<int>(wire::kMaxDataPacketSize + wire::kInterruptPacketSize) +
      settings.relay_delay;
  return settings.lap.count() != 0 && settings.lap != settings.nodes() * each;
}

std::size_t most_waiting(const core::Settings& settings) {
  return std::max(2u, settings.insertion_buffer) * wire::kMaxDataPacketSize;
}

PacketHeader header_of(const PacketFields& packet) { return PacketHeader::of(packet.bytes); }

/// What the CRC was when the packet left its source, as far as HOP and FBC go.
std::uint32_t crc_at_source(const PacketFields& packet) {
  return wire::carried_crc(packet.crc(), packet.bytes.size, packet.hop(), packet.fbc() ^ wire::kFbcUntaken);
}

// The right FBC: min(FBC, free buffers before), or 0 if refused. What was decided before gets the same verdict again,
// at least 1 if it was taken. (protocol.md sections 3.5 and 4.10)
ForwardingChecker::Due due(Answer answer, const PacketFields& packet, std::size_t free) {
  const auto least = [&](std::size_t value) {
    return static_cast<int>(std::min({std::size_t{packet.fbc()}, value, std::size_t{wire::kFbcMax}}));
  };
  const bool interrupt = packet.code().interrupt;
  switch (answer) {
    case Answer::none:
      return {packet.fbc()};
    case Answer::control:
      return {least(wire::kFbcMax)};
    case Answer::takes:
      return {least(interrupt ? 1 : free)};
    case Answer::refuses:
    case Answer::repeats_refused:
      return {0};
    case Answer::repeats_taken:
      return {least(interrupt ? 1 : std::max<std::size_t>(1, free)), Promise::exactly_once};
    case Answer::unknown:
      break;
  }
  return {ForwardingChecker::kAnyFbc};
}

}  // namespace

InputChecker::InputChecker(RingRecord& record) : record_(record) {
  for (const auto& node : record.nodes) incoming_.push_back({PacketCollector(stall_of(node->settings))});
}

void InputChecker::input_changes(NodeId node, Line line, Time now) {
  follow_input(node, now);
  incoming_[node].fold_known_until = Time{};
  if (line == incoming_[node].input) input_breaks_off(node, now);
}

// With the first `begin` that a node hears on the second line its input is another one, with a `last` or a `lost` it is
// lost: a DATP that was coming in there is broken off. (protocol.md sections 2.6 and 8.11) Which fold node a node knows
// cannot be told from outside, but that it still knows the one whose `begin` came a little earlier. By the word of its
// neighbour its output may be another one.
void InputChecker::word_arrives(NodeId node, wire::FoldWord word, Line line, Time now) {
  using Kind = wire::FoldWordKind;
  if (line != Line::second) return;
  const bool of_neighbour = word.kind == Kind::deaf || word.kind == Kind::hears;
  if (of_neighbour) return record_.at(node).line_may_have_changed();
  follow_input(node, now);
  Incoming& in = incoming_[node];
  const bool begins = word.kind == Kind::begin, known = now < in.fold_known_until;
  if (begins && (known || word.node == node)) return;
  const core::Duration surely = (wire::kMissedBeacons - 1) * record_.at(node).settings.beacon;
  in.fold_known_until = begins && record_.ring.alive(word.node) ? now + surely : Time{};
  record_.at(node).line_may_have_changed();
  if (in.input == Line::second && in.collector.open() && in.own) record_.ledger.returned_damaged(node, false);
}

// A fold may have left the line that the node heard, and come back to it in the same instant.
void InputChecker::follow_input(NodeId node, Time now) {
  const Line input = record_.ring.input_line(node);
  if (input == incoming_[node].input) return;
  input_breaks_off(node, now);
  incoming_[node].input = input;
}

void InputChecker::input_breaks_off(NodeId node, Time now) {
  Incoming& in = incoming_[node];
  if (!in.collector.open()) return;
  in.collector.drop();
  breaks_off(node, in.collector.size(), now);
}

// An own packet that comes home broken off is a failed try. (protocol.md section 4.3)
void InputChecker::breaks_off(NodeId node, std::size_t size, Time now) {
  record_.at(node).forwarding.broke_off(size, now);
  if (incoming_[node].own) record_.ledger.returned_damaged(node, false);
}

void InputChecker::arrives(NodeId node, const wire::Slice& slice, Time now) {
  Incoming& in = incoming_[node];
  if (in.last < now) check_insertion(node, now);
  in.last = now;
  follow_input(node, now);
  // What waited for the output when it turned back was dropped.
  if (in.output != record_.ring.output_line(node)) {
    in.output = record_.ring.output_line(node);
    if (in.output == Line::second) record_.at(node).forwarding.clear();
  }
  if (slice.kind == SliceKind::interrupt) return interrupt_arrives(node, PacketFields{slice.bytes}, now);
  const bool begins = slice.kind == SliceKind::start || slice.kind == SliceKind::whole;
  const bool was_open = in.collector.open();
  const std::size_t so_far = in.collector.size();
  if (in.collector.stalled(now)) in.collector.drop();
  const wire::ByteView packet = in.collector.put(slice, now);
  const bool goes_on = !begins && (in.collector.open() || !packet.empty());
  if (was_open && !goes_on) breaks_off(node, so_far, now);
  if (begins) begins_to_arrive(node, slice);
  if (packet.empty()) return;
  const PacketFields fields{packet};
  data_arrives(node, fields, now,
               slice.kind == SliceKind::whole ? now : record_.last_bit(node, wire::tail_size(packet.size), now));
}

void InputChecker::begins_to_arrive(NodeId node, const wire::Slice& slice) {
  incoming_[node].own = PacketHeader::of(slice.bytes).source == node;
  incoming_[node].received = is_received(node, slice.bytes, false);
}

// Whether a packet reaches Receive. (protocol.md sections 2.2 and 4.9) From outside nobody knows which sources are cut
// off on the second line, nor how full an insertion buffer is that holds aborted packets.
Tristate InputChecker::is_received(NodeId node, wire::ByteView bytes, bool interrupt) {
  NodeRecord& n = record_.at(node);
  const PacketHeader header = PacketHeader::of(bytes);
  if (!wire::header_valid(bytes, interrupt)) return Tristate::no;
  if (header.source == node) return Tristate::yes;
  if (header.hop + 1u >= n.settings.nodes()) return Tristate::no;
  if (incoming_[node].input == Line::second) return Tristate::unknown;
  const bool room = n.forwarding.bytes() + wire::kMaxDataPacketSize <= most_waiting(n.settings);
  return interrupt || room ? Tristate::yes : Tristate::unknown;
}

Sent* InputChecker::on_line(NodeId node, const PacketFields& packet) {
  return record_.ledger.on_line(packet.source(), packet.code(), packet.destination(), crc_at_source(packet), node);
}

Tristate InputChecker::has_buffer(NodeId node, const PacketFields& packet) {
  NodeRecord& n = record_.at(node);
  const std::uint8_t priority = wire::priority_of(packet.last());
  if (n.buffers.least(priority) >= n.settings.receive_buffers) return Tristate::no;
  return n.buffers.most(priority) < n.settings.receive_buffers ? Tristate::yes : Tristate::unknown;
}

void InputChecker::data_arrives(NodeId node, const PacketFields& packet, Time now, Time at_end) {
  NodeRecord& n = record_.at(node);
  const Tristate received = incoming_[node].received;
  if (received == Tristate::no) return;
  const NodeId source = packet.source(), destination = packet.destination();
  if (source == node) return comes_home(node, packet, at_end);
  const bool for_it = destination == node || destination == wire::kBroadcast;
  const bool good = !(for_it || record_.is_away(source)) || (wire::trailer_valid(packet.bytes) && packet.crc_good());
  ForwardingChecker::Due fbc{packet.fbc(), good ? Promise::true_fbc : Promise::undamaged, good};
  if (good && wire::is_control(packet)) {
    n.news_at = at_end;
    if (n.receiver.may_tell_of_forgetting(packet, received)) record_.ledger.receiver_forgot(node, source, now);
  }
  if (good && for_it) {
    Sent* sent = wire::is_control(packet) ? nullptr : on_line(node, packet);
    const std::size_t least = n.buffers.least(wire::priority_of(packet.last()));
    const bool sure = least == n.buffers.most(wire::priority_of(packet.last()));
    const std::size_t buffers = n.settings.receive_buffers;
    const std::size_t free = n.receiver.cpu_present() ? buffers - std::min(least, buffers) : 0;
    const Answer answer = offer(node, packet, sent, received, at_end);
    fbc = due(answer, packet, free);
    if (!sure && (answer == Answer::takes || answer == Answer::repeats_taken)) fbc.fbc = ForwardingChecker::kAnyFbc;
  }
  if (n.settings.fold_back || record_.ring.has_output(node))
    n.forwarding.came(header_of(packet), destination, fbc, packet.bytes.size, now);
}

Answer InputChecker::offer(NodeId node, const PacketFields& packet, Sent* sent, Tristate received, Time at_end) {
  NodeRecord& n = record_.at(node);
  // On a line without a rate its hello may leave in this instant, before the packet came. (protocol.md section 2.4)
  const bool leaves_now =
      n.history.state == core::NodeState::open_chain && n.settings.byte_time_out == core::Duration{0};
  const bool by_now = leaves_now || (n.hello_leaves() && record_.has_news(node, at_end));
  const bool may_have_joined = n.receiver.joined() == Tristate::no && by_now;
  if (may_have_joined) n.receiver.set_joined(Tristate::unknown);
  const Answer answer = n.receiver.data(packet, received, has_buffer(node, packet), record_.by_clock_of(node, at_end));
  if (may_have_joined) n.receiver.set_joined(Tristate::no);
  if (wire::is_control(packet)) return answer;
  const std::uint8_t priority = wire::priority_of(packet.last());
  if (answer == Answer::takes) record_.ledger.take(sent, packet, node, at_end);
  if (answer == Answer::refuses) record_.ledger.refuse(sent, node, at_end);
  if (answer == Answer::unknown && sent) sent->may_be_taken = true;
  if (answer == Answer::takes || answer == Answer::unknown)
    n.buffers.put(sent, packet.source(), priority, at_end, answer == Answer::takes);
  return answer;
}

void InputChecker::interrupt_arrives(NodeId node, const PacketFields& packet, Time now) {
  NodeRecord& n = record_.at(node);
  n.pins.judge(now);
  const Tristate received = is_received(node, packet.bytes, true);
  if (received == Tristate::no) return;
  const Time at_end = record_.last_bit(node, wire::kInterruptPacketSize, now);
  const NodeId destination = packet.destination();
  if (packet.source() == node) return comes_home(node, packet, at_end);
  const bool for_it = destination == node || destination == wire::kBroadcast;
  const bool good = wire::trailer_valid(packet.bytes) && packet.crc_good();
  ForwardingChecker::Due fbc{packet.fbc(), good ? Promise::true_fbc : Promise::undamaged, good};
  if (good && for_it) fbc = due(offer_interrupt(node, packet, on_line(node, packet), received, at_end), packet, 1);
  if (n.settings.fold_back || record_.ring.has_output(node))
    n.forwarding.came(header_of(packet), destination, fbc, wire::kInterruptPacketSize, now);
}

Answer InputChecker::offer_interrupt(NodeId node, const PacketFields& packet, Sent* sent, Tristate received,
                                     Time at_end) {
  NodeRecord& n = record_.at(node);
  const Answer answer = n.receiver.interrupt(packet, received, record_.by_clock_of(node, at_end));
  if (answer == Answer::takes) record_.ledger.take(sent, packet, node, at_end);
  if (answer == Answer::unknown && sent) sent->may_be_taken = true;
  if (answer == Answer::takes || answer == Answer::unknown)
    n.pins.put(packet.source(), wire::factor_of(packet.last()), at_end, answer == Answer::takes);
  return answer;
}

// A packet to the own node is received when it comes home. (protocol.md section 4.2)
void InputChecker::comes_home(NodeId node, const PacketFields& packet, Time at_end) {
  NodeRecord& n = record_.at(node);
  const bool interrupt = packet.code().interrupt;
  if (!packet.crc_good() || !wire::trailer_valid(packet.bytes)) {
    if (!interrupt) n.damaged_at = at_end;
    return record_.ledger.returned_damaged(node, interrupt);
  }
  if (!interrupt && wire::is_control(packet)) {
    const bool is_last = n.control.crc == crc_at_source(packet) && n.control.code == packet.code_byte();
    // Of two copies that came home damaged in the instant in which this try left, the second one may have ended it.
    const bool sure = !record_.ledger.was_damaged(node, false) && n.damaged_at < n.control.left &&
                      !(n.control.hello && n.control.may_be_dropped);
    n.control_home = at_end;
    n.hello_out = false;
    n.receiver.announce(is_last && sure, record_.by_clock_of(node, at_end));
    if (is_last && n.control.hello) sure ? n.receiver.join() : n.receiver.set_joined(Tristate::unknown);
    if (is_last) n.control = {};
    return;
  }
  const auto [sent, last] = record_.ledger.returned(node, packet.code(), packet.destination(), crc_at_source(packet));
  // A fold drops what it was just given: a retry may have been sent, and never seen.
  const bool retried = n.settings.fold_back && sent && at_end - sent->last_try >= n.settings.send_timeout();
  const bool sure = last && !retried && !record_.has_news(node, at_end);
  int fbc = sure ? packet.fbc() : ForwardingChecker::kAnyFbc;
  if (packet.destination() == node && (sent || record_.ledger.others_send(node))) {
    const Tristate received = sent && sure && may_send(n.history.state) ? Tristate::yes : Tristate::unknown;
    const std::size_t buffers = n.settings.receive_buffers;
    const std::size_t free = buffers - std::min(n.buffers.least(wire::priority_of(packet.last())), buffers);
    const Answer answer =
        interrupt ? offer_interrupt(node, packet, sent, received, at_end) : offer(node, packet, sent, received, at_end);
    fbc = due(answer, packet, free).fbc;
  }
  if (interrupt && sent) n.interrupt_free = at_end;
  record_.ledger.come_home(sent, fbc, at_end);
}

// While nothing is lost, a node whose output is no slower than its input lags behind it by its own DATP and INTP at
// most. A DATP on the line counts in full until its end is through. (protocol.md section 2.5)
void InputChecker::check_insertion(NodeId node, Time now) {
  constexpr std::size_t kNormal = 2 * wire::kMaxDataPacketSize + wire::kInterruptPacketSize;
  NodeRecord& n = record_.at(node);
  if (!record_.ring.has_output(node)) n.dropped_until = now;
  if (now < record_.settled_from || n.dropped_until == now || n.settings.byte_time_out > n.settings.byte_time_in)
    return;
  if (n.forwarding.bytes() <= kNormal || lines_differ(n.settings)) return;
  // What came in more than a worst lap ago and has not left was dropped, as is what comes if there is no output.
  const Time since = std::max(now - n.settings.worst_lap(), n.dropped_until + core::Duration{1});
  const std::size_t bytes = n.forwarding.bytes_since(since);
  if (bytes > kNormal)
    record_.complain(Promise::insertion_bound, std::to_string(bytes) + " bytes wait in " + node_words(node) + ", " +
                                                   std::to_string(kNormal) + " may");
}

}  // namespace limb_ring::sim
