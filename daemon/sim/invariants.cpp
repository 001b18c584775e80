#include "sim/invariants.h"

#include <algorithm>

namespace limb_ring::sim {

using core::NodeState;
using wire::PacketFields;
using wire::SliceKind;
using Answer = ReceiverModel::Answer;

namespace {

/// The longest pause between two slices of a DATP. (protocol.md section 7.4)
core::Duration stall_of(const core::Settings& settings) { return settings.stall + 2048 * settings.byte_time_in; }

/// Then what a slow line has held up comes all at once further on, and the bound is not promised.
bool lines_differ(const core::Settings& settings) {
  const core::Duration each =
      settings.byte_time_out * static_cast<int>(wire::kMaxDataPacketSize + wire::kOverhead) + settings.relay_delay;
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

std::size_t tail_size(const PacketFields& packet) {
  return packet.data().size % 4 + wire::kTrailerSize + wire::kCrcSize;
}

}  // namespace

Invariants::Node::Node(const core::Settings& of_node, Ledger& ledger, const Complain& complain)
    : settings(of_node),
      forwarding(settings.id, settings.byte_time_out, settings.byte_time_in, complain),
      buffers(settings.id, ledger, complain),
      receiver(settings),
      pins(settings.id, complain),
      coming(stall_of(settings)),
      going(core::Duration::max()) {}

Invariants::Invariants(VirtualRing& ring)
    : ring_(ring),
      complain_([this](Promise promise, std::string what) { complain(promise, std::move(what)); }),
      ledger_(ring.size(), complain_) {
  for (unsigned id = 0; id < ring.size(); ++id)
    nodes_.push_back(std::make_unique<Node>(ring.settings(static_cast<NodeId>(id)), ledger_, complain_));
  for (const auto& node : nodes_) settling_ = std::max(settling_, 4 * node->settings.send_timeout());
  ring.add_observer(*this);
}

void Invariants::complain(Promise promise, std::string what) {
  if (!violation_) violation_ = Violation{promise, ring_.now(), std::move(what)};
}

void Invariants::finish() {
  ledger_.settle(core::kNever);
  for (unsigned id = 0; id < ring_.size(); ++id) {
    const auto node = static_cast<NodeId>(id);
    if (!ring_.alive(node)) continue;
    at(node).pins.judge(ring_.now());
    judge_open(node, true);
    judge_unexplained(node);
  }
}

// ---- CPUs -----------------------------------------------------------------------------------

void Invariants::asked(NodeId node, const core::SendRequest& request, Time now) {
  judge_open(node, false);
  ledger_.ask(node, request, may_send(at(node).history.state), now);
}

void Invariants::asked(NodeId node, const core::InterruptRequest& request, Time now) {
  judge_open(node, false);
  ledger_.ask(node, request, may_send(at(node).history.state), now);
}

void Invariants::output_ready(NodeId node, bool, Time now) { at(node).forwarding.released(now); }

void Invariants::cpu_present(NodeId node, bool present, Time) { at(node).receiver.set_cpu_present(present); }

void Invariants::packet(NodeId node, const core::ReceivedPacket& packet) { at(node).buffers.read(packet, ring_.now()); }

void Invariants::event(NodeId node, const core::Event& event) {
  if (const auto* state = std::get_if<core::StateChanged>(&event.what)) state_changes(node, state->after, event.at);
  if (const auto* pin = std::get_if<core::PinPulled>(&event.what)) at(node).pins.pulled(*pin, event.at);
  if (const auto* end = std::get_if<core::SendEnded>(&event.what)) ends(node, *end, event.at);
}

// A hello that has left counts as home in an open chain. (protocol.md section 4.8)
void Invariants::state_changes(NodeId node, NodeState state, Time now) {
  Node& n = at(node);
  n.history.state = state;
  n.history.state_at = ring_.now();
  const auto explains = [&](core::Outcome outcome) {
    const auto of_it = [&](const Unexplained& result) { return result.outcome == outcome; };
    n.unexplained.erase(std::remove_if(n.unexplained.begin(), n.unexplained.end(), of_it), n.unexplained.end());
  };
  if (state == NodeState::open_chain) explains(core::Outcome::unconfirmed);
  if (!may_send(state)) explains(core::Outcome::rejected);
  if (state == NodeState::open_chain && n.hello_left && n.receiver.joined() != Tristate::yes)
    n.receiver.set_joined(Tristate::unknown);
  if (state != NodeState::starting && state != NodeState::duplicate_id) return;
  explains(core::Outcome::cancelled);
  if (state == NodeState::starting) ledger_.forgets_interrupts(node);
  // A hello may leave in the same instant, and is told first.
  n.began = ring_.now();
  n.hello_left = n.control.hello && n.control.left == n.began;
  if (!n.hello_left) n.control = {};
  n.receiver.start_over(state == NodeState::starting, now);
  ledger_.waits_for_nothing(node);
}

// ---- results --------------------------------------------------------------------------------

Time Invariants::last_hello_of(NodeId destination) const {
  if (destination == wire::kBroadcast) return said_hello_;
  return destination < nodes_.size() ? nodes_[destination]->history.said_hello : core::kNever;
}

ResultJudge Invariants::judge_of(NodeId node, const Sent& sent) const {
  const Node& n = *nodes_[node];
  return {sent, n.settings, n.history, last_hello_of(sent.destination), was_broken_};
}

void Invariants::ends(NodeId node, const core::SendEnded& end, Time at_end) {
  Node& n = at(node);
  const bool paced = end.outcome == core::Outcome::unconfirmed;  // as it left. (protocol.md section 8.4)
  if (end.interrupt) n.interrupt_free = at_end + (paced ? n.settings.open_chain_interrupt_pace() : core::Duration{0});
  ledger_.settle(at_end);
  judge_unexplained(node);
  // If tries fail or numbers are used up, copies are under way, and a hello may come between them.
  if (end.tries > 1 || end.outcome == core::Outcome::lost || end.outcome == core::Outcome::no_such_node)
    disturbed(at_end);
  const Sent* sent = ledger_.end(node, end, at_end);
  if (!sent) return;
  const std::string ended = sent->name() + " ended " + core::to_string(end.outcome);
  if (const char* objection = judge_of(node, *sent).objection()) complain(Promise::true_result, ended + objection);
  if (end.outcome == core::Outcome::cancelled && n.history.cancelled != at_end)
    n.unexplained.push_back({ring_.now(), end.outcome, ended + ", and nobody had cancelled it"});
  if (end.outcome == core::Outcome::unconfirmed && n.history.state != NodeState::open_chain)
    n.unexplained.push_back({ring_.now(), end.outcome, ended + ", and its node is in no open chain"});
  const bool was_in_ring = sent->asked_in_ring && n.history.state_at < sent->asked;
  if (end.reject == core::Reject::not_in_ring && was_in_ring)
    n.unexplained.push_back({ring_.now(), end.outcome, ended + ", and its node was in a ring"});
}

// A node that starts over ends its sends before it shows that; and what a beacon says is acted on when its end begins,
// and shown when its last bit is in.
void Invariants::judge_unexplained(NodeId node) {
  const core::Duration tail = at(node).settings.byte_time_in * static_cast<std::int64_t>(wire::kOverhead);
  for (const Unexplained& result : at(node).unexplained)
    if (result.when + tail < ring_.now()) complain(Promise::true_result, result.what);
}

void Invariants::judge_open(NodeId node, bool all) {
  ledger_.each_open(node, [&](const Sent& sent) {
    if (all || judge_of(node, sent).due() < ring_.now()) complain(Promise::one_result, sent.name() + " has not ended");
  });
}

// ---- out of a node --------------------------------------------------------------------------

void Invariants::check_header(NodeId node, const PacketHeader& header) {
  const std::string what = "a packet of node " + std::to_string(header.source) + " with HOP " +
                           std::to_string(header.hop) + " left node " + std::to_string(node);
  if (header.source == node && header.hop != 0) complain(Promise::no_circling, what + ", its source");
  if (header.hop >= ring_.order().size()) complain(Promise::no_circling, what + ": it has gone round");
}

// The packets of a node that is gone have passed after one time-out; or one time-out after a line released them.
void Invariants::check_source(NodeId node, const PacketHeader& header, Time now) {
  if (header.source >= ring_.size()) return;
  const auto& away = at(header.source).away_since;
  const core::Settings& settings = at(node).settings;
  if (away && now - std::max(*away, released_) > settings.send_timeout() + settings.worst_lap())
    complain(Promise::no_circling, "a packet of node " + std::to_string(header.source) + " goes on through node " +
                                       std::to_string(node) + ", long after its source was gone");
}

void Invariants::leaves(NodeId node, const wire::Slice& slice, Time now) {
  Node& n = at(node);
  const bool begins = slice.kind == SliceKind::start || slice.kind == SliceKind::whole;
  if (begins) begins_to_leave(node, slice, now);
  wire::ByteView own;
  if (n.going_own) own = n.going.put(slice, now);
  if (slice.kind == SliceKind::whole || slice.kind == SliceKind::end) data_leaves(node, slice, own, now);
  if (slice.kind == SliceKind::interrupt) interrupt_leaves(node, slice, now);
}

void Invariants::begins_to_leave(NodeId node, const wire::Slice& slice, Time now) {
  Node& n = at(node);
  n.header = PacketHeader::of(slice.bytes);
  n.going_own = n.header.source == node;
  n.going_since = now;
  check_header(node, n.header);
  if (!n.going_own) return;
  n.control = {};  // what is out now is this one
  ledger_.try_begins(node, n.header.code, now);
}

void Invariants::data_leaves(NodeId node, const wire::Slice& end, wire::ByteView own, Time now) {
  Node& n = at(node);
  if (!n.going_own) {
    if (n.forwarding.went(n.header, PacketTrailer::of(end.bytes), now)) check_source(node, n.header, now);
  } else if (!own.empty()) {
    own_data_leaves(node, PacketFields{own});
  }
}

void Invariants::own_data_leaves(NodeId node, const PacketFields& packet) {
  Node& n = at(node);
  const bool control = wire::is_control(packet);
  const auto hello = control ? wire::decode_hello(packet.data()) : std::nullopt;
  if (hello) {
    n.hello_left = true;
    n.receiver.says_hello(hello->boot);
    n.history.said_hello = said_hello_ = ring_.now();
  }
  // Nothing else is sent before the hello is home. (protocol.md section 4.8)
  n.hello_out = hello.has_value();
  const bool joins = hello ? n.history.state == NodeState::open_chain : n.receiver.joined() != Tristate::yes;
  if (joins && n.going_since > n.began) n.receiver.join();
  if (control) {
    n.control = {packet.code_byte(), packet.crc(), hello.has_value(), ring_.now()};
    return ledger_.try_is_control(node);
  }
  ledger_.depart(node, packet.code(),
                 {packet.destination(), wire::priority_of(packet.last()), wire::channel_of(packet.last()),
                  packet.data().size, packet.crc(), wire::crc32(packet.data())},
                 n.going_since);
}

void Invariants::interrupt_leaves(NodeId node, const wire::Slice& slice, Time now) {
  const PacketHeader header = PacketHeader::of(slice.bytes);
  const PacketTrailer tail = PacketTrailer::of(slice.bytes);
  check_header(node, header);
  Node& n = at(node);
  if (header.source != node) {
    if (n.forwarding.went(header, tail, now)) check_source(node, header, now);
  } else {
    const bool free = !ledger_.awaits(node, true);
    ledger_.try_begins(node, header.code, now);
    const Sent* sent = ledger_.depart(node, header.code, {tail.destination, 4, tail.last, 0, tail.crc, 0}, now);
    if (sent && sent->tries == 1 && free && !n.hello_out && sent->asked >= settled_from_ &&
        n.history.state != NodeState::open_chain)
      n.forwarding.own_interrupt_went(std::max({sent->asked, n.interrupt_free, n.history.state_at, n.control_home}),
                                      now);
  }
  n.forwarding.count_interrupt(now);
}

// ---- into a node ----------------------------------------------------------------------------

void Invariants::input_changes(NodeId node, Line line, Time now) {
  Node& n = at(node);
  if (line != n.input || !n.coming.open()) return;
  n.coming.drop();
  breaks_off(node, n.coming.size(), now);
}

// An own packet that comes home broken off is a failed try. (protocol.md section 4.3)
void Invariants::breaks_off(NodeId node, std::size_t size, Time now) {
  at(node).forwarding.broke_off(size, now);
  if (at(node).coming_own) ledger_.returned_damaged(node, false);
}

void Invariants::arrives(NodeId node, const wire::Slice& slice, Time now) {
  Node& n = at(node);
  if (n.arrived < now) check_insertion(node, now);
  n.arrived = now;
  if (n.input != ring_.input_line(node)) {
    input_changes(node, n.input, now);
    n.input = ring_.input_line(node);
  }
  // What waited for the output when it turned back was dropped.
  if (n.output != ring_.output_line(node)) {
    n.output = ring_.output_line(node);
    if (n.output == Line::second) n.forwarding.clear();
  }
  if (slice.kind == SliceKind::interrupt) return interrupt_arrives(node, PacketFields{slice.bytes}, now);
  const bool begins = slice.kind == SliceKind::start || slice.kind == SliceKind::whole;
  const bool was_open = n.coming.open();
  const std::size_t so_far = n.coming.size();
  if (n.coming.stalled(now)) n.coming.drop();
  const wire::ByteView packet = n.coming.put(slice, now);
  const bool goes_on = !begins && (n.coming.open() || !packet.empty());
  if (was_open && !goes_on) breaks_off(node, so_far, now);
  if (begins) begins_to_arrive(node, slice);
  if (packet.empty()) return;
  const PacketFields fields{packet};
  data_arrives(node, fields, now, slice.kind == SliceKind::whole ? now : last_bit(node, tail_size(fields), now));
}

void Invariants::begins_to_arrive(NodeId node, const wire::Slice& slice) {
  at(node).coming_own = PacketHeader::of(slice.bytes).source == node;
  at(node).received = is_received(node, slice.bytes, false);
}

// Whether it reaches Receive. (protocol.md sections 2.2 and 4.9) Of what comes on the second line nobody outside knows
// whose source is cut off; and of a buffer that may be full, what of it was aborted.
Tristate Invariants::is_received(NodeId node, wire::ByteView bytes, bool interrupt) {
  Node& n = at(node);
  const PacketHeader header = PacketHeader::of(bytes);
  if (!wire::header_valid(bytes, interrupt)) return Tristate::no;
  if (header.source == node) return Tristate::yes;
  if (header.hop + 1u >= n.settings.nodes()) return Tristate::no;
  if (n.input == Line::second) return Tristate::unknown;
  const bool room = n.forwarding.bytes() + wire::kMaxDataPacketSize <= most_waiting(n.settings);
  return interrupt || room ? Tristate::yes : Tristate::unknown;
}

Sent* Invariants::on_line(const PacketFields& packet) {
  return ledger_.on_line(packet.source(), packet.code(), packet.destination(), crc_at_source(packet));
}

Tristate Invariants::has_buffer(NodeId node, const PacketFields& packet) {
  Node& n = at(node);
  const std::uint8_t priority = wire::priority_of(packet.last());
  if (n.buffers.least(priority) >= n.settings.receive_buffers) return Tristate::no;
  return n.buffers.most(priority) < n.settings.receive_buffers ? Tristate::yes : Tristate::unknown;
}

void Invariants::data_arrives(NodeId node, const PacketFields& packet, Time now, Time at_end) {
  Node& n = at(node);
  if (n.received == Tristate::no) return;
  const NodeId source = packet.source(), destination = packet.destination();
  if (source == node) return comes_home(node, packet, at_end);
  const bool for_it = destination == node || destination == wire::kBroadcast;
  const bool good = !(for_it || is_away(source)) || (wire::trailer_valid(packet.bytes) && packet.crc_good());
  ForwardingChecker::Due fbc{packet.fbc(), good ? Promise::true_fbc : Promise::undamaged, good};
  if (good && wire::is_control(packet)) n.news_at = at_end;
  if (good && for_it) {
    Sent* sent = wire::is_control(packet) ? nullptr : on_line(packet);
    const std::size_t least = n.buffers.least(wire::priority_of(packet.last()));
    const bool sure = least == n.buffers.most(wire::priority_of(packet.last()));
    const std::size_t buffers = n.settings.receive_buffers;
    const std::size_t free = buffers - std::min(least, buffers);
    const Answer answer = offer(node, packet, sent, n.received, at_end);
    fbc = due(node, answer, packet, free);
    if (!sure && (answer == Answer::takes || answer == Answer::repeats_taken)) fbc.fbc = ForwardingChecker::kAnyFbc;
  }
  if (n.settings.fold_back || ring_.has_output(node))
    n.forwarding.came(header_of(packet), destination, fbc, packet.bytes.size, now);
}

// min(FBC, free buffers before), 0 where refused; the same verdict, at least 1 where it was taken, for what was decided
// before. (protocol.md sections 3.5 and 4.10)
ForwardingChecker::Due Invariants::due(NodeId, Answer answer, const PacketFields& packet, std::size_t free) const {
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

// A beacon may have told of a break, which the node shows when the instant is over.
bool Invariants::has_news(NodeId node, Time now) const {
  const Node& n = *nodes_[node];
  return n.news_at + n.settings.byte_time_in * static_cast<std::int64_t>(wire::kOverhead) >= now;
}

Answer Invariants::offer(NodeId node, const PacketFields& packet, Sent* sent, Tristate received, Time at_end) {
  Node& n = at(node);
  const bool may_have_joined = n.receiver.joined() == Tristate::no && n.hello_left && has_news(node, at_end);
  if (may_have_joined) n.receiver.set_joined(Tristate::unknown);
  const Answer answer = n.receiver.data(packet, received, has_buffer(node, packet), at_end);
  if (may_have_joined) n.receiver.set_joined(Tristate::no);
  if (wire::is_control(packet)) return answer;
  const std::uint8_t priority = wire::priority_of(packet.last());
  if (answer == Answer::takes) ledger_.take(sent, packet.source(), node, priority);
  if (answer == Answer::refuses) ledger_.refuse(sent, node);
  if (answer == Answer::unknown && sent) sent->may_be_taken = true;
  if (answer == Answer::takes || answer == Answer::unknown)
    n.buffers.put(sent, packet.source(), priority, at_end, answer == Answer::takes);
  return answer;
}

void Invariants::interrupt_arrives(NodeId node, const PacketFields& packet, Time now) {
  Node& n = at(node);
  n.pins.judge(now);
  const Tristate received = is_received(node, packet.bytes, true);
  if (received == Tristate::no) return;
  const Time at_end = last_bit(node, wire::kInterruptPacketSize, now);
  const NodeId destination = packet.destination();
  if (packet.source() == node) return comes_home(node, packet, at_end);
  const bool for_it = destination == node || destination == wire::kBroadcast;
  const bool good = wire::trailer_valid(packet.bytes) && packet.crc_good();
  ForwardingChecker::Due fbc{packet.fbc(), good ? Promise::true_fbc : Promise::undamaged, good};
  if (good && for_it) fbc = due(node, offer_interrupt(node, packet, on_line(packet), received, at_end), packet, 1);
  if (n.settings.fold_back || ring_.has_output(node))
    n.forwarding.came(header_of(packet), destination, fbc, wire::kInterruptPacketSize, now);
}

Answer Invariants::offer_interrupt(NodeId node, const PacketFields& packet, Sent* sent, Tristate received,
                                   Time at_end) {
  Node& n = at(node);
  const Answer answer = n.receiver.interrupt(packet, received, at_end);
  if (answer == Answer::takes) ledger_.take(sent, packet.source(), node, 4);
  if (answer == Answer::unknown && sent) sent->may_be_taken = true;
  if (answer == Answer::takes || answer == Answer::unknown)
    n.pins.put(packet.source(), wire::factor_of(packet.last()), at_end, answer == Answer::takes);
  return answer;
}

// A packet to the own node is received when it comes home. (protocol.md section 4.2)
void Invariants::comes_home(NodeId node, const PacketFields& packet, Time at_end) {
  Node& n = at(node);
  const bool interrupt = packet.code().interrupt;
  if (!packet.crc_good() || !wire::trailer_valid(packet.bytes)) return ledger_.returned_damaged(node, interrupt);
  if (!interrupt && wire::is_control(packet)) {
    const bool is_last = n.control.crc == crc_at_source(packet) && n.control.code == packet.code_byte();
    const bool sure = !ledger_.was_damaged(node, false);
    n.control_home = at_end;
    n.hello_out = false;
    if (is_last && n.control.hello) sure ? n.receiver.join() : n.receiver.set_joined(Tristate::unknown);
    if (is_last) n.control = {};
    return;
  }
  const auto [sent, last] = ledger_.returned(node, packet.code(), packet.destination(), crc_at_source(packet));
  // A fold drops what it was just given: a retry may have been sent, and never seen.
  const bool retried = n.settings.fold_back && sent && at_end - sent->last_try >= n.settings.send_timeout();
  const bool sure = last && !retried && !has_news(node, at_end);
  int fbc = sure ? packet.fbc() : ForwardingChecker::kAnyFbc;
  if (packet.destination() == node && (sent || ledger_.others_send(node))) {
    const Tristate received = sent && sure && may_send(n.history.state) ? Tristate::yes : Tristate::unknown;
    const std::size_t buffers = n.settings.receive_buffers;
    const std::size_t free = buffers - std::min(n.buffers.least(wire::priority_of(packet.last())), buffers);
    const Answer answer =
        interrupt ? offer_interrupt(node, packet, sent, received, at_end) : offer(node, packet, sent, received, at_end);
    fbc = due(node, answer, packet, free).fbc;
  }
  if (interrupt && sent) n.interrupt_free = at_end;
  ledger_.come_home(sent, fbc, at_end);
}

// A slice comes as its last bytes begin.
Time Invariants::last_bit(NodeId node, std::size_t tail_size, Time now) const {
  return now + nodes_[node]->settings.byte_time_in * static_cast<std::int64_t>(tail_size);
}

// While nothing is lost a node whose output is no slower is behind its input by its own DATP and INTP; what has left of
// the DATP on the line counts until its end is through. (protocol.md section 2.5)
void Invariants::check_insertion(NodeId node, Time now) {
  constexpr std::size_t kNormal = 2 * wire::kMaxDataPacketSize + wire::kInterruptPacketSize;
  const Node& n = at(node);
  if (now < settled_from_ || !ring_.has_output(node) || n.settings.byte_time_out > n.settings.byte_time_in) return;
  if (n.forwarding.bytes() <= kNormal || lines_differ(n.settings)) return;
  // What has come earlier was dropped.
  const std::size_t bytes = n.forwarding.bytes_since(now - n.settings.worst_lap());
  if (bytes > kNormal)
    complain(Promise::insertion_bound, std::to_string(bytes) + " bytes wait in node " + std::to_string(node) + ", " +
                                           std::to_string(kNormal) + " may");
}

// ---- faults ---------------------------------------------------------------------------------

void Invariants::incident(NodeId node, Incident incident, Time now, Line) {
  disturbed(now);
  if (incident != Incident::cpu_reset && incident != Incident::cancelled) was_broken_ = true;
  if (incident == Incident::late_slice) {
    released_ = now;
    ledger_.line_released(now);
  }
  Node& n = at(node);
  if (incident == Incident::killed || incident == Incident::frozen) n.away_since = now;
  if (incident == Incident::started || incident == Incident::thawed) n.away_since.reset();
  if (incident == Incident::thawed) n.history.thawed = now;
  if (incident == Incident::killed) judge_open(node, false);
  if (incident == Incident::started) {
    ledger_.start(node);
    n.receiver = ReceiverModel(n.settings);
    n.history.state = NodeState::starting;
    n.history.state_at = now;
    n.history.cancelled = core::kNever;
    n.unexplained.clear();
    n.began = now;
    n.hello_left = false;
    n.control = {};
    n.pins.clear();
    n.coming.drop();
  }
  if (incident == Incident::started || incident == Incident::cpu_reset) n.buffers.flush();
  if (incident == Incident::cpu_reset || incident == Incident::cancelled) {
    ledger_.cancel(node, now);
    n.history.cancelled = now;
  }
  // The buffers of a line that is replaced are emptied, unless what waits goes on over the second line.
  const bool emptied = incident == Incident::output_replaced && !n.settings.fold_back;
  if (incident == Incident::started || emptied) n.forwarding.clear();
}

}  // namespace limb_ring::sim
