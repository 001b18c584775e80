#include "wire/packet_trace.h"

#include <algorithm>

#include "wire/checksum.h"
#include "wire/packet.h"

namespace limb_ring::capture {

using std::chrono::nanoseconds;

namespace {

std::uint32_t data_of(const SeenPacket& seen, const wire::PacketFields& fields) {
  return seen.interrupt() ? 0 : wire::crc32(fields.data());
}

}  // namespace

SeenPacket seen(const CapturedPacket& packet) {
  const wire::PacketFields fields{{packet.bytes.data(), packet.bytes.size()}};
  SeenPacket seen;
  seen.last = std::max(nanoseconds(packet.time_ns), nanoseconds(0));
  seen.began = std::max(seen.last - packet.info.span, nanoseconds(0));
  seen.info = packet.info;
  seen.code = fields.code_byte();
  seen.hop = fields.hop();
  seen.source = fields.source();
  seen.size = static_cast<std::uint16_t>(packet.bytes.size());
  const bool whole = PacketView{{}, packet.info, fields.bytes}.whole();
  if (whole)
    seen.trailer = SeenPacket::Trailer{fields.fbc(), fields.destination(), fields.last(), data_of(seen, fields)};
  return seen;
}

bool SeenPacket::may_be(const SeenPacket& other) const {
  if (source != other.source || interrupt() != other.interrupt()) return false;
  const bool both_whole = trailer && other.trailer && !info.crc_bad && !other.info.crc_bad;
  if (!both_whole) return true;
  return size == other.size && trailer->destination == other.trailer->destination &&
         trailer->last == other.trailer->last && trailer->data == other.trailer->data;
}

std::optional<nanoseconds> Hop::waited() const {
  if (!in || !out) return std::nullopt;
  return out->began - in->began;
}

nanoseconds PacketTrace::waited() const {
  nanoseconds all{0};
  for (const Hop& hop : hops) all += hop.waited().value_or(nanoseconds(0));
  return all;
}

std::optional<nanoseconds> PacketTrace::on_line(std::size_t hop) const {
  if (hop == 0 || hops[hop].unseen != 0 || !hops[hop].in || !hops[hop - 1].out) return std::nullopt;
  return hops[hop].in->began - hops[hop - 1].out->began;
}

const char* to_string(TripEnd end) {
  switch (end) {
    case TripEnd::home:
      return "came home";
    case TripEnd::refused:
      return "came home refused";
    case TripEnd::damaged:
      return "came home damaged";
    case TripEnd::broken:
      return "came home broken off";
    case TripEnd::not_home:
      return "did not come home";
  }
  return "";
}

namespace {

using wire::kInterruptPacketSize;  // the longest tail there is

/// Bytes that go with the last slice: all of an INTP; odd bytes, trailer and CRC of a DATP.
std::size_t tail_of(const SeenPacket& packet) {
  return packet.interrupt() ? packet.size : wire::tail_size(packet.size);
}

bool carries(const SeenPacket& packet, const SeenPacket& interrupt) {
  return interrupt.info.embedded && !packet.interrupt() && packet.source == interrupt.info.carrier_source &&
         packet.code == interrupt.info.carrier_code && packet.began <= interrupt.began &&
         interrupt.began <= packet.last;
}

}  // namespace

void LineHistory::add(const SeenPacket& packet) {
  packets_.push_back(&packet);
  longest_ = std::max(longest_, packet.last - packet.began);
  if (packet.interrupt() || !packet.trailer) return;
  // What is embedded makes a packet longer: the shortest time of a byte is the line's.
  const auto bytes = static_cast<double>(packet.size - tail_of(packet));
  const double byte_ns = static_cast<double>((packet.last - packet.began).count()) / bytes;
  byte_ns_ = byte_ns_ < 0 ? byte_ns : std::min(byte_ns_, byte_ns);
}

nanoseconds LineHistory::time_of(std::size_t bytes) const {
  return nanoseconds(static_cast<std::int64_t>(std::max(byte_ns_, 0.0) * static_cast<double>(bytes)));
}

nanoseconds LineHistory::free_after(const SeenPacket& packet) const {
  return packet.trailer ? packet.last + time_of(tail_of(packet)) : packet.last;
}

std::vector<const SeenPacket*>::const_iterator LineHistory::first_since(nanoseconds time) const {
  return std::lower_bound(packets_.begin(), packets_.end(), time,
                          [](const SeenPacket* packet, nanoseconds since) { return packet->began < since; });
}

std::vector<SeenPacket> LineHistory::in_front_of(const SeenPacket& in, const SeenPacket& out) const {
  std::vector<SeenPacket> front, carrier;
  const nanoseconds since = in.began - longest_ - time_of(kInterruptPacketSize);
  for (auto at = first_since(since); at != packets_.end() && (*at)->began < out.began; ++at)
    if (free_after(**at) > in.began) (carries(**at, out) ? carrier : front).push_back(**at);
  return front.empty() && out.began > in.began ? carrier : front;
}

std::vector<SeenPacket> LineHistory::inside(const SeenPacket& out) const {
  std::vector<SeenPacket> found;
  for (auto at = first_since(out.began); at != packets_.end() && (*at)->began <= out.last; ++at)
    if (carries(out, **at)) found.push_back(**at);
  return found;
}

namespace {

/// A second, and what a living ring may be late.
constexpr std::chrono::milliseconds kSentAgainFor{1100};

wire::Code code_of(const EarlierTries::Try& one) { return wire::code_of(one.seen.code); }

}  // namespace

std::optional<std::size_t> EarlierTries::before(const Try& now) {
  const Known* found = code_of(now).attempt > 0 ? try_before(now) : refused_before(now);
  const bool goes_on = found != nullptr && found->tried.end == TripEnd::refused;
  const std::optional<std::size_t> index = found == nullptr ? std::nullopt : std::optional(found->index);
  remember({now, count_++, goes_on ? found->refused_since : now.ended});
  return index;
}

void EarlierTries::remember(const Known& known) {
  const SeenPacket& seen = known.tried.seen;
  std::map<std::uint8_t, Known>& tries = by_try_[{seen.source, seen.interrupt()}];
  const std::uint8_t attempt = code_of(known.tried).attempt;
  if (attempt == 0 ||
      (!tries.empty() && code_of(tries.begin()->second.tried).sequence != code_of(known.tried).sequence))
    tries.clear();
  tries.insert_or_assign(attempt, known);
  if (seen.trailer && !seen.interrupt())
    by_route_.insert_or_assign({seen.source, seen.trailer->destination, seen.trailer->last}, known);
}

const EarlierTries::Known* EarlierTries::try_before(const Try& now) const {
  const auto tries = by_try_.find({now.seen.source, now.seen.interrupt()});
  if (tries == by_try_.end()) return nullptr;
  wire::Code code = code_of(now);
  --code.attempt;
  const auto found = tries->second.find(code.attempt);
  if (found == tries->second.end()) return nullptr;
  const SeenPacket& seen = found->second.tried.seen;
  return seen.code == code.byte() && seen.may_be(now.seen) ? &found->second : nullptr;
}

const EarlierTries::Known* EarlierTries::refused_before(const Try& now) const {
  const std::optional<SeenPacket::Trailer>& trailer = now.seen.trailer;
  if (!trailer || now.seen.interrupt() || trailer->destination == wire::kBroadcast) return nullptr;
  const auto found = by_route_.find({now.seen.source, trailer->destination, trailer->last});
  if (found == by_route_.end()) return nullptr;
  const Known& known = found->second;
  const bool next = code_of(now).sequence == ((code_of(known.tried).sequence + 1) & 7);
  const bool again = known.tried.end == TripEnd::refused && next && known.tried.seen.may_be(now.seen) &&
                     now.began - known.refused_since <= kSentAgainFor;
  return again ? &known : nullptr;
}

}  // namespace limb_ring::capture
