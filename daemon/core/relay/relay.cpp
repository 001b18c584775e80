#include "core/relay/relay.h"

#include <algorithm>

namespace limb_ring::core {

using wire::ByteView;
using wire::PacketFields;
using wire::SliceKind;

Relay::Effect Relay::receive(const wire::Slice& slice, Time now) {
  switch (slice.kind) {
    case SliceKind::whole:
      return on_whole(slice, now);
    case SliceKind::start:
      return on_start(slice.bytes, now);
    case SliceKind::more:
      return on_more(slice.bytes, now);
    case SliceKind::end:
      return on_end(slice.bytes, now);
    case SliceKind::interrupt:
      on_interrupt(slice.bytes, now);
      break;
    case SliceKind::abort:
      if (incoming_.open())
        break_off(counters_.aborts_received, now);
      else
        ++counters_.stray_slices;
      break;
    case SliceKind::idle:
    case SliceKind::fold:
      break;
  }
  return {};
}

// ---- what becomes of it -------------------------------------------------------------------

Relay::Fate Relay::judge(ByteView header, bool interrupt) {
  const NodeId source{header[wire::field::kSource]};
  if (!wire::header_valid(header, interrupt)) {
    counters_.last_malformed = {source, header[wire::field::kHop]};
    return counted(counters_.malformed_packets, Fate::discard);
  }
  if (source == settings_.id) return Fate::strip;
  if (cut_off_[source]) return counted(counters_.orphans_cut_off, Fate::discard);
  if (header[wire::field::kHop] + 1u >= settings_.nodes()) return counted(counters_.orphans_hop, Fate::discard);
  if (bypassed_[source]) return counted(counters_.orphans_bypassed, Fate::receive_only);
  return Fate::pass_on;
}

Relay::Fate Relay::judge_data(ByteView header) {
  const Fate fate = judge(header, false);
  if (fate != Fate::pass_on || packet_manager_.has_room()) return fate;
  ++counters_.insertion_buffer_full;
  return Fate::discard;
}

bool Relay::check(const PacketFields& packet, bool crc_good) {
  if (!crc_good) return counted(counters_.crc_errors, false);
  if (wire::trailer_valid(packet.bytes)) return true;
  counters_.last_malformed = {packet.source(), packet.hop()};
  return counted(counters_.malformed_packets, false);
}

/// The nodes that come after `before` and before `behind` in ring order.
std::bitset<256> Relay::between(NodeId before, NodeId behind) const {
  std::bitset<256> nodes;
  const RingOrder& order = settings_.order;
  const std::size_t at = place_of(order, before);
  for (std::size_t lines = 1; lines < order.size(); ++lines) {
    const NodeId next = order[(at + lines) % order.size()];
    if (next == behind) break;
    nodes.set(next);
  }
  return nodes;
}

// ---- DATP -----------------------------------------------------------------------------------

Relay::Effect Relay::on_whole(const wire::Slice& slice, Time now) {
  const ByteView bytes = slice.bytes;
  const bool broke_off_own = break_off(counters_.broken_off_packets, now);
  const PacketFields packet{bytes};
  const Fate fate = judge_data(bytes);
  if (fate == Fate::discard) return {broke_off_own};
  const bool good = check(packet, slice.crc_good());
  if (fate == Fate::strip) {
    returns_.data(packet, good, now);
    return {};
  }
  const bool own = broke_off_own || (good && receive_.heeds(packet));
  const std::uint8_t fbc = good ? receive_.pass(packet, now) : packet.fbc();
  if (fate != Fate::pass_on) return {own};
  const PacketManager::Place place = packet_manager_.relay_whole(bytes.size, now);
  if (place.bytes == nullptr) return {own};
  std::copy(bytes.begin(), bytes.end(), place.bytes);
  wire::rewrite(place.bytes, bytes.size, static_cast<std::uint8_t>(packet.hop() + 1), fbc);
  return {own, place.on_line};
}

Relay::Effect Relay::on_start(ByteView bytes, Time now) {
  const bool broke_off_own = break_off(counters_.broken_off_packets, now);
  fate_ = judge_data(bytes);
  std::uint8_t* place = fate_ == Fate::pass_on ? packet_manager_.relay_begin(now) : nullptr;
  incoming_.begin(bytes, now, place);
  if (!place) return {broke_off_own};
  ++place[wire::field::kHop];
  packet_manager_.relay_words(bytes.size);
  return {broke_off_own};
}

bool Relay::append(ByteView bytes, Time now, std::size_t most) {
  if (!incoming_.open()) {
    ++counters_.stray_slices;
    return false;
  }
  if (incoming_.append(bytes, now, most)) return true;
  const PacketFields packet{incoming_.bytes()};
  counters_.last_oversize = {packet.source(), packet.hop()};
  break_off(counters_.oversize_packets, now);
  return false;
}

Relay::Effect Relay::on_more(ByteView bytes, Time now) {
  const std::size_t most = wire::kHeaderSize + wire::kMaxPayload;  // trailer and CRC come with the end alone
  if (!append(bytes, now, most)) return {};
  if (fate_ == Fate::pass_on) packet_manager_.relay_words(bytes.size);
  return {false};
}

// An `end` slice comes when its bytes (last odd bytes, trailer, CRC) begin on the line; they are in at `at`.
Relay::Effect Relay::on_end(ByteView bytes, Time now) {
  if (!append(bytes, now, wire::kMaxDataPacketSize)) return {};
  const PacketFields packet{incoming_.bytes()};
  if (packet.bytes.size < wire::kMinDataPacketSize) return {break_off(counters_.malformed_packets, now)};
  incoming_.close();
  if (fate_ == Fate::discard) return {false};
  const auto tail = static_cast<std::int64_t>(wire::tail_size(packet.bytes.size));
  const Time at = now + settings_.byte_time_in * tail;
  const bool good = check(packet, packet.crc_good());
  if (fate_ == Fate::strip) {
    returns_.data(packet, good, at);
    return {};
  }
  const bool own = good && receive_.heeds(packet);
  const std::uint8_t fbc = good ? receive_.pass(packet, at) : packet.fbc();
  if (fate_ != Fate::pass_on) return {own};
  wire::rewrite(incoming_.place(), packet.bytes.size, static_cast<std::uint8_t>(packet.hop() + 1), fbc);
  packet_manager_.relay_end(bytes.size, now);
  return {own};
}

// The DATP that is coming in will never be complete; each relay passes the abort on. An INTP embedded in it goes on.
bool Relay::break_off(std::uint64_t& counter, Time now) {
  if (!incoming_.open()) return false;
  incoming_.close();
  ++counter;
  if (fate_ == Fate::pass_on) packet_manager_.relay_abort();
  if (fate_ == Fate::strip) returns_.broken_off(now);
  return fate_ == Fate::strip;
}

// ---- INTP -----------------------------------------------------------------------------------

void Relay::on_interrupt(ByteView bytes, Time now) {
  const PacketFields packet{bytes};
  const Fate fate = judge(bytes, true);
  if (fate == Fate::discard) return;
  const Time at = now + settings_.byte_time_in * static_cast<std::int64_t>(wire::kInterruptPacketSize);
  const bool good = check(packet, packet.crc_good());
  if (fate == Fate::strip) return returns_.interrupt(packet, good, at);
  const std::uint8_t fbc = good ? pins_.pass(packet, at) : packet.fbc();
  if (fate != Fate::pass_on) return;
  wire::InterruptBytes copy;
  std::copy(bytes.begin(), bytes.end(), copy.begin());
  wire::rewrite(copy.data(), copy.size(), static_cast<std::uint8_t>(packet.hop() + 1), fbc);
  packet_manager_.relay_interrupt(copy, now);
}

using wire::PacketFields;

void Returns::data(const PacketFields& packet, bool good, Time at) {
  if (!good) return damaged(transmit_.data, at);
  const std::uint8_t fbc = fbc_of(packet, transmit_.data, receive_, at);
  const bool matched = match(transmit_.data, packet, fbc, at);
  membership_.own_seen(packet, matched, at);
}

void Returns::interrupt(const PacketFields& packet, bool good, Time at) {
  if (!good) return damaged(transmit_.interrupts, at);
  match(transmit_.interrupts, packet, fbc_of(packet, transmit_.interrupts, pins_, at), at);
}

void Returns::damaged(SendUnit& unit, Time at) {
  ++counters_.returns_damaged;
  unit.returned_damaged(at);
}

// A packet to oneself is taken when it returns. Before the own hello is home it is only taken off the ring, as is a
// copy that nobody waits for any more.
template <class Block>
std::uint8_t Returns::fbc_of(const PacketFields& packet, const SendUnit& unit, Block& block, Time at) {
  const bool to_self = packet.destination() == settings_.id && membership_.accepts_sends() && unit.expects(packet);
  return to_self ? block.offer(packet, at) : packet.fbc();
}

bool Returns::match(SendUnit& unit, const PacketFields& packet, std::uint8_t fbc, Time at) {
  const bool matched = unit.returned(packet, fbc, membership_.has_merged(packet.hop(), at), at);
  if (matched)
    membership_.came_home(packet.hop(), at);
  else
    ++counters_.returns_unmatched;
  return matched;
}

}  // namespace limb_ring::core
