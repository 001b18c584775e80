// The blocks Relay and Receive up to where a packet is whole: protocol.md sections 2.2, 2.3 and 2.6.
#include <algorithm>

#include "model/node.h"

namespace limb_ring::model {

/// A part of so many bytes may leave so much later than it is known. (protocol.md section 6.4)
Duration Node::behind(std::size_t bytes) const {
  const Duration difference = settings_.byte_time_in - settings_.byte_time_out;
  return difference > Duration{0} ? static_cast<int>(bytes) * difference : Duration{0};
}

void Node::receive(const Given& slice, Time now) {
  const Bytes& bytes = slice.bytes;
  const auto add = [&] {
    incoming_->bytes.insert(incoming_->bytes.end(), bytes.begin(), bytes.end());
    incoming_->heard = now;
  };
  switch (slice.kind) {
    case SliceKind::start:
    case SliceKind::whole:
      break_off_input(now);
      datp_begins(bytes, now);
      if (slice.kind == SliceKind::whole) {  // all of it is in
        if (incoming_->relayed) incoming_->relayed->since = incoming_->relayed->header_at = now;
        datp_ends(now, true);
      }
      break;
    case SliceKind::more:
      if (!incoming_) break;  // stray
      add();
      if (incoming_->bytes.size() > 516) return break_off_input(now);
      if (incoming_->relayed) {
        Bytes& out = incoming_->relayed->bytes;
        out.insert(out.end(), bytes.begin(), bytes.end());
      }
      break;
    case SliceKind::end:
      if (!incoming_) break;  // stray
      add();
      if (incoming_->bytes.size() > 524 || incoming_->bytes.size() < 13) return break_off_input(now);
      datp_ends(now);
      break;
    case SliceKind::abort:
      break_off_input(now);
      break;
    case SliceKind::interrupt:
      intp(bytes, now);
      break;
    default:
      return;
  }
  new_hello_when_due(now);                                // what has come may have ended what was out
  if (settings_.byte_time_out == Duration{0}) step(now);  // protocol.md section 2.4
}

bool Node::bypasses(int source) const {
  if (!out_.up || out_.folded || !configured(source)) return false;
  const unsigned to = out_.neighbour == id() ? count_nodes() : distance(id(), out_.neighbour);
  const unsigned away = distance(id(), source);
  return away > 0 && away < to;
}

std::size_t Node::insertion_bytes() const {
  std::size_t bytes = 0;
  for (const auto& relayed : relayed_) bytes += relayed->bytes.size();
  return bytes;
}

// protocol.md section 2.2. The first rule that fits.
Incoming::Fate Node::fate_of(const Bytes& header, bool interrupt, Time) {
  using Fate = Incoming::Fate;
  if ((header[0] >> 5 & 1) != (interrupt ? 1 : 0) || header[1] != kSop || header[3] == 0xFF) return Fate::not_received;
  if (header[3] == id()) return Fate::own;
  if (cut_off(header[3])) return Fate::not_received;
  if (header[2] + 1u >= count_nodes()) return Fate::not_received;
  if (bypasses(header[3])) return Fate::received_only;
  if (!out_.up) return Fate::received_only;
  if (!interrupt && insertion_bytes() + 524 > settings_.insertion_buffer * 524) return Fate::not_received;
  return Fate::passed_on;
}

void Node::datp_begins(const Bytes& bytes, Time now) {
  Incoming in;
  in.fate = fate_of(bytes, false, now);
  in.bytes = bytes;
  in.heard = now;
  if (in.fate == Incoming::Fate::passed_on) {
    in.relayed = std::make_shared<Relayed>();
    in.relayed->bytes = bytes;
    in.relayed->bytes[2] = static_cast<std::uint8_t>(bytes[2] + 1);
    in.relayed->since = in.relayed->header_at = now + behind(4);
    relayed_.push_back(in.relayed);
  }
  incoming_ = std::move(in);
}

void Node::datp_ends(Time now, bool at_once) {
  Incoming in = std::move(*incoming_);
  incoming_.reset();
  whole_datp(in, at_once, now);
}

void Node::whole_datp(Incoming& in, bool at_once, Time now) {
  Packet packet{in.bytes};
  const std::size_t tail = (in.bytes.size() - 12) % 4 + 8;
  const Time at = at_once ? now : now + static_cast<int>(tail) * settings_.byte_time_in;
  const bool right = packet.crc_right() && packet.eop() == kEop;
  if (in.fate == Incoming::Fate::own) {
    if (right) return returned(packet, at, now);
    if (data_.flight && !data_.flight->waits_since) try_failed(data_, at);
    return;
  }
  int fbc = packet.fbc();
  if (right && in.fate != Incoming::Fate::not_received) fbc = std::min(fbc, answer(packet, at, now));
  if (!in.relayed) return;
  const int hop = packet.hop() + 1;
  packet.rewrite(hop, fbc);
  in.relayed->bytes = packet.bytes;
  in.relayed->complete = true;
  in.relayed->end_at = at_once ? now : now + behind(tail);
}

/// protocol.md section 2.6.
void Node::break_off_input(Time now) {
  if (!incoming_) return;
  const Incoming in = std::move(*incoming_);
  incoming_.reset();
  if (in.fate == Incoming::Fate::own && data_.flight && !data_.flight->waits_since) try_failed(data_, now);
  if (!in.relayed) return;
  if (outgoing_ && outgoing_->relayed == in.relayed) {
    in.relayed->broken = true;
    return;
  }
  relayed_.erase(std::remove(relayed_.begin(), relayed_.end(), in.relayed), relayed_.end());
}

void Node::intp(const Bytes& bytes, Time now) {
  const Incoming::Fate fate = fate_of(bytes, true, now);
  if (fate == Incoming::Fate::not_received) return;
  Packet packet{bytes};
  const Time at = now + 12 * settings_.byte_time_in;
  const bool right = packet.crc_right() && packet.eop() == kEop;
  if (fate == Incoming::Fate::own) {
    if (right) return returned(packet, at, now);
    if (interrupts_.flight && !interrupts_.flight->waits_since) try_failed(interrupts_, at);
    return;
  }
  int fbc = packet.fbc();
  if (right) fbc = std::min(fbc, answer(packet, at, now));
  if (fate != Incoming::Fate::passed_on || relayed_interrupts_.size() >= settings_.interrupt_buffer) return;
  packet.rewrite(packet.hop() + 1, fbc);
  relayed_interrupts_.push_back({packet.bytes, now + behind(12), now + behind(12)});
}

}  // namespace limb_ring::model
