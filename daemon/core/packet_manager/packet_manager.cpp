#include "core/packet_manager/packet_manager.h"

#include <algorithm>

namespace limb_ring::core {

using wire::ByteView;
using wire::SliceKind;

PacketManager::PacketManager(const Settings& settings, Transmit& transmit, Counters& counters, wire::SliceWriter& line)
    : settings_(settings),
      transmit_(transmit),
      counters_(counters),
      line_(line),
      buffer_(std::max(2u, settings.insertion_buffer)) {}

// ---- from Relay ---------------------------------------------------------------------------

// Nothing else is on the line, or asks for it.
bool PacketManager::line_is_free(Time now) const {
  return !paced() && ready_ && !is_open_ && buffer_.empty() && interrupts_.empty() && transmit_.data.ready_at() > now &&
         transmit_.interrupts.ready_at() > now;
}

PacketManager::Place PacketManager::relay_whole(std::size_t size, Time now) {
  if (!output_up_) {
    count_drop(1);
    return {nullptr, false};
  }
  ++counters_.relayed_data;
  if (line_is_free(now)) return {line_.put_space(SliceKind::whole, size), true};
  RelayedPacket& packet = buffer_.push(now);
  buffer_.grow(size);
  packet.state = RelayedPacket::State::complete;
  return {packet.bytes.data(), false};
}

std::uint8_t* PacketManager::relay_begin(Time now) {
  receiving_ = output_up_;
  if (!output_up_) {
    count_drop(1);
    return nullptr;
  }
  return buffer_.push(now + lag(wire::kHeaderSize)).bytes.data();
}

void PacketManager::relay_end(std::size_t bytes, Time now) {
  if (!receiving_) return;
  receiving_ = false;
  ++counters_.relayed_data;
  buffer_.grow(bytes);
  RelayedPacket& packet = buffer_.back();
  packet.tail_at = now + lag(wire::tail_size(packet.size));
  packet.state = RelayedPacket::State::complete;
}

void PacketManager::relay_abort() {
  if (!receiving_) return;
  receiving_ = false;
  const bool is_on_line = is_open_ && !open_.own && buffer_.count() == 1;
  if (!is_on_line) return buffer_.pop_back();
  buffer_.back().state = RelayedPacket::State::aborted;
}

void PacketManager::relay_interrupt(const wire::InterruptBytes& packet, Time now) {
  if (!output_up_) return count_drop(1);
  if (interrupts_.size() >= settings_.interrupt_buffer) {
    ++counters_.interrupt_buffer_full;
    return;
  }
  ++counters_.relayed_interrupts;
  interrupts_.push() = {packet, now + lag(wire::kInterruptPacketSize)};
}

// ---- the line -----------------------------------------------------------------------------

void PacketManager::output_up(Time now) {
  free_at_ = now;
  output_up_ = true;
  ready_ = true;
}

void PacketManager::output_lost() {
  count_drop(buffer_.count() + interrupts_.size());
  buffer_.clear();
  interrupts_.clear();
  line_.clear();
  receiving_ = false;
  is_open_ = false;
  output_up_ = false;
}

// What waited for a line that took nothing goes now, not when it could have gone.
bool PacketManager::run(Time now) {
  if (released_) free_at_ = std::max(free_at_, now);
  released_ = own_begun_ = false;
  while (may_put(now) && step(now)) {
  }
  return own_begun_;
}

// What goes onto the line next, if something may go now. (paper; protocol.md sections 2.4 and 5.2)
bool PacketManager::step(Time now) {
  // An INTP goes before any DATP, also inside the one that is on the line.
  const Time interrupt = interrupt_at();
  if (interrupt <= now) {
    put_interrupt(paced() ? interrupt : now);
    return true;
  }

  // A DATP that has begun is finished before the next one.
  if (is_open_) return advance_open(now);

  // What came in first goes first; on a tie Transmit wins over Relay.
  const Time own = transmit_.data.ready_at();
  const Time relayed = relayed_since();
  const Time since = std::min(own, relayed);
  if (since > now) return false;
  open_data(own <= relayed, paced() ? std::max(since, free_at_) : now);
  return true;
}

Time PacketManager::deadline() const {
  if (!output_up_ || !ready_) return kNever;
  Time next = interrupt_at();
  if (!is_open_)
    next = std::min(next, std::min(transmit_.data.ready_at(), relayed_since()));
  else if (open_aborted())
    next = std::min(next, free_at_);
  else if (open_complete())
    next = std::min(next, open_end_at());
  return next == kNever ? kNever : std::max(next, free_at_);
}

// ---- interrupts ---------------------------------------------------------------------------

// The instant at which an INTP that waits since then may begin: at once, or inside an open DATP at its next word
// boundary; kNever where it has to wait for the open DATP's last odd bytes, trailer and CRC.
Time PacketManager::interrupt_place(Time since) const {
  const Time at = std::max(since, free_at_);
  if (!is_open_) return at;
  if (!settings_.embed_interrupts) return kNever;
  const Time word = next_word(at);
  if (!open_complete() || !paced()) return word;
  // Just before the trailer is a word boundary too, also if the trailer lags behind the words.
  const Time end = open_end_at();
  return at <= end ? std::min(word, end) : kNever;
}

// What came in first goes first; on a tie the own one does.
void PacketManager::put_interrupt(Time at) {
  if (is_open_) {
    put_words_until(at);
    ++counters_.embedded_interrupts;
    open_.grid += bytes_time(wire::kInterruptPacketSize);
  }
  if (interrupts_.empty() || transmit_.interrupts.ready_at() <= interrupts_.front().arrived) {
    own_begun_ = true;
    line_.put(SliceKind::interrupt, transmit_.interrupts.start(at));
  } else {
    const wire::InterruptBytes& packet = interrupts_.front().bytes;
    line_.put(SliceKind::interrupt, {packet.data(), packet.size()});
    interrupts_.pop();
  }
  free_at_ = at + bytes_time(wire::kInterruptPacketSize);
}

// ---- the DATP on the line -----------------------------------------------------------------

ByteView PacketManager::open_bytes() const {
  if (open_.own) return open_.own_bytes;
  const RelayedPacket& slot = buffer_.front();
  return {slot.bytes.data(), slot.size};
}

Time PacketManager::next_word(Time from) const {
  const Duration word = bytes_time(4);
  if (word.count() == 0 || from <= open_.grid) return std::max(from, open_.grid);
  const auto words = (from - open_.grid + word - Duration{1}) / word;
  return open_.grid + words * word;
}

// When the end slice goes: after all whole words, not before it came in, nor inside an INTP.
Time PacketManager::open_end_at() const {
  const std::size_t payload = open_bytes().size - wire::kOverhead;
  const Time words_out = open_.grid + bytes_time(payload / 4 * 4);
  const Time tail_at = open_.own ? words_out : buffer_.front().tail_at;
  return std::max(std::max(words_out, tail_at), free_at_);
}

// Gives out the whole words of payload that precede the instant `at` on the line, as far as they
// have come in.
void PacketManager::put_words_until(Time at) {
  const ByteView bytes = open_bytes();
  std::size_t until = bytes.size - (open_complete() ? wire::kTrailerSize + wire::kCrcSize : 0);
  if (paced()) until = std::min<std::size_t>(until, wire::kHeaderSize + (at - open_.grid) / bytes_time(1));
  until -= until % wire::kWord;
  if (until <= open_.sent) return;
  line_.put(SliceKind::more, bytes.from(open_.sent).first(until - open_.sent));
  open_.sent = until;
}

bool PacketManager::advance_open(Time now) {
  if (open_aborted()) {
    line_.put(SliceKind::abort, {});
    free_at_ = std::max(free_at_, now);  // what comes next begins now, not when the line was last through
    close_open();
    return true;
  }
  if (!open_complete()) {
    if (!paced()) put_words_until(now);
    return false;
  }
  const Time end = open_end_at();
  if (end > now) return false;
  const ByteView bytes = open_bytes();
  line_.put(SliceKind::end, bytes.from(open_.sent));
  free_at_ = end + bytes_time(wire::tail_size(bytes.size));
  close_open();
  return true;
}

void PacketManager::close_open() {
  is_open_ = false;
  if (!open_.own) buffer_.pop();
}

void PacketManager::open_data(bool own, Time at) {
  open_.own = own;
  own_begun_ = own_begun_ || own;
  if (own) open_.own_bytes = transmit_.data.start(at);
  is_open_ = true;
  const ByteView bytes = open_bytes();
  if (!paced() && open_complete()) {
    line_.put(SliceKind::whole, bytes);
    return close_open();
  }
  open_.sent = paced() ? wire::kHeaderSize : bytes.size;
  line_.put(SliceKind::start, bytes.first(open_.sent));
  free_at_ = at + bytes_time(wire::kHeaderSize);
  open_.grid = free_at_;
}

}  // namespace limb_ring::core
