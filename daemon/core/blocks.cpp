#include "core/blocks.h"

#include <algorithm>

#include "core/mutation.h"

namespace limb_ring::core {

using wire::ByteView;
using wire::PacketFields;
using wire::SliceKind;

Blocks::Blocks(const Settings& settings)
    : settings_(settings),
      transmit_(settings_, counters_, events_),
      memory_(settings_.send_timeout()),
      receive_(settings_, memory_, counters_),
      pins_(settings_, memory_, counters_, events_),
      relay_(settings_, counters_),
      packet_manager_(settings_, transmit_, counters_, line_),
      membership_(settings_, transmit_, receive_, memory_, counters_, events_) {}

// ---- the lines ----------------------------------------------------------------------------

void Blocks::input_up(NodeId from, Time now) {
  break_off(counters_.broken_off_packets, now);
  membership_.input_up(from, now);
}

void Blocks::input_lost(Time now) {
  break_off(counters_.broken_off_packets, now);
  membership_.input_lost(now);
}

void Blocks::input_gap(Time now) { break_off(counters_.broken_off_packets, now); }

void Blocks::output_up(NodeId to, Time now) {
  packet_manager_.output_lost();
  packet_manager_.output_up(now);
  relay_.set_successor(to);
  membership_.output_up(to, now);
}

void Blocks::output_lost(Time now) {
  packet_manager_.output_lost();
  membership_.output_lost(now);
}

void Blocks::output_replaced(Time now) {
  packet_manager_.output_lost();
  packet_manager_.output_up(now);
}

void Blocks::set_neighbours(NodeId before, NodeId next, NodeId successor) {
  relay_.set_successor(successor);
  membership_.set_neighbours(before, next);
}

void Blocks::receive(const wire::Slice& slice, Time now) {
  // The usual case: it has passed straight to the line, and nothing else has changed.
  if (slice.kind == SliceKind::whole && on_whole(slice.bytes, now)) return;
  switch (slice.kind) {
    case SliceKind::whole: break;
    case SliceKind::start: on_start(slice.bytes, now); break;
    case SliceKind::more: on_more(slice.bytes, now); break;
    case SliceKind::end: on_end(slice.bytes, now); break;
    case SliceKind::interrupt: on_interrupt(slice.bytes, now); break;
    case SliceKind::abort:
      if (incoming_.open())
        break_off(counters_.aborts_received, now);
      else
        ++counters_.stray_slices;
      break;
    case SliceKind::idle:
    case SliceKind::fold: break;
  }
  membership_.settle(now);
  // Where the line takes time, everything that comes in at one instant competes for it (run());
  // where it takes none, what has come in goes on at once, so that a batch never fills the buffer.
  if (settings_.byte_time_out.count() == 0) packet_manager_.run(now);
}

Blocks::Fate Blocks::fate_of_data(ByteView header) {
  const Fate fate = relay_.fate(header, false);
  if (fate != Fate::pass_on || packet_manager_.has_room()) return fate;
  ++counters_.insertion_buffer_full;
  return Fate::discard;
}

bool Blocks::on_whole(ByteView bytes, Time now) {
  break_off(counters_.broken_off_packets, now);
  const PacketFields packet{bytes};
  const Fate fate = fate_of_data(bytes);
  if (fate == Fate::discard) return false;
  const bool good = check(packet);
  if (fate == Fate::strip) {
    data_came_home(packet, good, now);
    return false;
  }
  const std::uint8_t fbc = receive_data(packet, good, now);
  return fate == Fate::pass_on && packet_manager_.relay_whole(bytes, fbc, now);
}

void Blocks::on_start(ByteView bytes, Time now) {
  break_off(counters_.broken_off_packets, now);
  const Fate fate = fate_of_data(bytes);
  std::uint8_t* place = fate == Fate::pass_on ? packet_manager_.relay_begin(now) : nullptr;
  incoming_.begin(fate, bytes, now, place);
  if (place) packet_manager_.relay_header(bytes.size);
}

bool Blocks::append(ByteView bytes, Time now, std::size_t most) {
  if (!incoming_.open()) {
    ++counters_.stray_slices;
    return false;
  }
  if (incoming_.append(bytes, now, most)) return true;
  break_off(counters_.oversize_packets, now);
  return false;
}

void Blocks::on_more(ByteView bytes, Time now) {
  const std::size_t most = wire::kHeaderSize + wire::kMaxPayload;  // trailer and CRC come with the end alone
  if (append(bytes, now, most) && incoming_.fate() == Fate::pass_on) packet_manager_.relay_words(bytes.size);
}

// An `end` slice comes as the last odd bytes, trailer and CRC begin on the line; they are in a few byte times later.
void Blocks::on_end(ByteView bytes, Time now) {
  if (!append(bytes, now, wire::kMaxDataPacketSize)) return;
  const PacketFields packet{incoming_.bytes()};
  if (packet.bytes.size < wire::kMinDataPacketSize) return break_off(counters_.malformed_packets, now);
  incoming_.close();
  if (incoming_.fate() == Fate::discard) return;
  const auto tail = static_cast<std::int64_t>(packet.data().size % 4 + wire::kTrailerSize + wire::kCrcSize);
  const Time at = now + settings_.byte_time_in * tail;
  const bool good = check(packet);
  if (incoming_.fate() == Fate::strip) return data_came_home(packet, good, at);
  const std::uint8_t fbc = receive_data(packet, good, at);
  if (incoming_.fate() == Fate::pass_on) packet_manager_.relay_end(bytes.size, fbc, now);
}

// The DATP that is coming in will never be complete; each relay passes the abort on. An INTP embedded in it goes on.
void Blocks::break_off(std::uint64_t& counter, Time now) {
  if (!incoming_.open()) return;
  incoming_.close();
  ++counter;
  if (incoming_.fate() == Fate::pass_on) packet_manager_.relay_abort();
  if (incoming_.fate() != Fate::strip) return;
  ++counters_.returns_damaged;
  transmit_.data.returned_damaged(now);
}

void Blocks::on_interrupt(ByteView bytes, Time now) {
  const PacketFields packet{bytes};
  const Fate fate = relay_.fate(bytes, true);
  if (fate == Fate::discard) return;
  const Time at = now + settings_.byte_time_in * static_cast<std::int64_t>(wire::kInterruptPacketSize);
  const bool good = check(packet);
  if (fate == Fate::strip) return interrupt_came_home(packet, good, at);
  const bool takes = good && !is_strangers_retry(packet);
  const std::uint8_t fbc = takes ? pins_.offer(packet, at) : packet.fbc();
  if (fate != Fate::pass_on) return;
  wire::InterruptBytes copy;
  std::copy(bytes.begin(), bytes.end(), copy.begin());
  wire::rewrite(copy.data(), copy.size(), static_cast<std::uint8_t>(packet.hop() + 1), fbc);
  packet_manager_.relay_interrupt(copy, now);
}

// ---- what passes --------------------------------------------------------------------------

bool Blocks::check(const PacketFields& packet) {
  if (!packet.crc_good() && ++counters_.crc_errors && !broken(Mutation::takes_damaged)) return false;
  if (!wire::trailer_valid(packet.bytes)) return ++counters_.malformed_packets, false;
  return true;
}

// Its first try may have been taken before this node's restart. The source may not know of that restart: it was in the
// other part of a ring that was broken twice. (ours, protocol.md section 4.10)
bool Blocks::is_strangers_retry(const PacketFields& packet) {
  if (!settings_.fold_back || packet.code().attempt == 0 || membership_.peers()[packet.source()].known) return false;
  return ++counters_.retries_of_strangers, true;
}

std::uint8_t Blocks::receive_data(const PacketFields& packet, bool good, Time at) {
  if (!good) return packet.fbc();
  if (is_control(packet) && !membership_.heard(packet, at)) return 0;
  if (is_strangers_retry(packet)) return packet.fbc();
  return receive_.offer(packet, at);
}

void Blocks::data_came_home(const PacketFields& packet, bool good, Time at) {
  if (!good) {
    ++counters_.returns_damaged;
    return transmit_.data.returned_damaged(at);
  }
  // A packet to oneself is taken when it returns; before the own hello is home it is only stripped, as is
  // a copy that nobody waits for any more.
  const bool to_self = packet.destination() == settings_.id && membership_.accepts_sends() &&
                       transmit_.data.expects(packet);
  const std::uint8_t fbc = to_self ? receive_.offer(packet, at) : packet.fbc();
  const bool matched = transmit_.data.returned(packet, fbc, membership_.has_merged(packet.hop(), at), at);
  if (matched)
    membership_.came_home(packet.hop(), at);
  else
    ++counters_.returns_unmatched;
  membership_.own_seen(packet, matched, at);
}

void Blocks::interrupt_came_home(const PacketFields& packet, bool good, Time at) {
  if (!good) {
    ++counters_.returns_damaged;
    return transmit_.interrupts.returned_damaged(at);
  }
  const bool to_self = packet.destination() == settings_.id && membership_.accepts_sends() &&
                       transmit_.interrupts.expects(packet);
  const std::uint8_t fbc = to_self ? pins_.offer(packet, at) : packet.fbc();
  const bool matched = transmit_.interrupts.returned(packet, fbc, membership_.has_merged(packet.hop(), at), at);
  if (matched)
    membership_.came_home(packet.hop(), at);
  else
    ++counters_.returns_unmatched;
}

// ---- the CPU ------------------------------------------------------------------------------

bool Blocks::destination_exists(NodeId destination) const {
  const auto& order = settings_.order;
  return destination == wire::kBroadcast || std::find(order.begin(), order.end(), destination) != order.end();
}

Reject Blocks::refuse_reason(const SendRequest& request) const {
  if (request.data.size < 1 || request.data.size > wire::kMaxPayload) return Reject::bad_size;
  if (request.priority > 3) return Reject::bad_priority;
  if (request.channel > 63 || request.channel == static_cast<std::uint8_t>(wire::Channel::control))
    return Reject::bad_channel;
  if (!destination_exists(request.destination)) return Reject::bad_destination;
  return membership_.accepts_sends() ? Reject::none : Reject::not_in_ring;
}

Reject Blocks::refuse_reason(const InterruptRequest& request) const {
  if (request.factor >= wire::kFactors) return Reject::bad_factor;
  if (!destination_exists(request.destination)) return Reject::bad_destination;
  return membership_.accepts_sends() ? Reject::none : Reject::not_in_ring;
}

void Blocks::reject(const SendRequest& request, Reject reason, Time now) {
  ++counters_.ended_rejected;
  events_.put(now, SendEnded{request.owner, request.token, Outcome::rejected, reason, Duration{0}, 0, false,
                             request.destination});
}

void Blocks::reject(const InterruptRequest& request, Reject reason, Time now) {
  ++counters_.ended_rejected;
  events_.put(now, SendEnded{request.owner, request.token, Outcome::rejected, reason, Duration{0}, 0, true,
                             request.destination, request.factor});
}

void Blocks::send(const SendRequest& request, Time now) {
  Reject reason = refuse_reason(request);
  if (reason == Reject::none) reason = transmit_.data.enqueue(request, now);
  if (reason != Reject::none) reject(request, reason, now);
}

void Blocks::interrupt(const InterruptRequest& request, Time now) {
  Reject reason = refuse_reason(request);
  if (reason == Reject::none) reason = transmit_.interrupts.enqueue(request, now);
  if (reason != Reject::none) reject(request, reason, now);
}

void Blocks::pull(Owner owner, std::uint32_t token, unsigned input, Time now) {
  if (input >= settings_.inputs.size() || !settings_.inputs[input])
    return reject(InterruptRequest{owner, token, 0, 0}, Reject::input_unwired, now);
  interrupt({owner, token, settings_.inputs[input]->destination, settings_.inputs[input]->factor}, now);
}

void Blocks::cpu_reset(Owner cpu, Time now) {
  transmit_.cancel(cpu, now);
  receive_.flush();
}

// ---- time ---------------------------------------------------------------------------------

void Blocks::handle_timeout(Time now) {
  if (stall_deadline() <= now) break_off(counters_.stalled_packets, now);
  transmit_.handle_timeout(now);
  membership_.handle_timeout(now);
  membership_.settle(now);
}

void Blocks::run(Time now) {
  membership_.settle(now);
  packet_manager_.run(now);
  membership_.settle(now);
}

Time Blocks::next_deadline(Time now) const {
  // A packet that the CPU does not read is no reason to wake up.
  const Time received = receive_.next() > now ? receive_.next() : kNever;
  const Time node = std::min(std::min(stall_deadline(), transmit_.deadline()), membership_.deadline());
  return std::min(std::min(node, packet_manager_.deadline()), std::min(events_.next(), received));
}

}  // namespace limb_ring::core
