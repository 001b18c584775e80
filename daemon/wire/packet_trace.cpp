#include "wire/packet_trace.h"

#include <algorithm>

#include "wire/checksum.h"

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

}  // namespace limb_ring::capture
