#include "wire/line_history.h"

#include <algorithm>

#include "wire/interrupt_packet.h"

namespace limb_ring::capture {

using std::chrono::nanoseconds;

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

}  // namespace limb_ring::capture
