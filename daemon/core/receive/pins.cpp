#include "core/receive/pins.h"

#include <algorithm>

namespace limb_ring::core {

bool Pins::addressed(const wire::PacketFields& packet) const {
  if (packet.destination() == wire::kBroadcast) return packet.source() != settings_.id;
  return packet.destination() == settings_.id;
}

std::uint8_t Pins::offer(const wire::PacketFields& packet, Time at) {
  if (!addressed(packet)) return packet.fbc();
  if (!memory_.meet(packet.source(), packet.code().incarnation))
    return counted(counters_.earlier_incarnation, std::uint8_t{0});
  const bool broadcast = packet.destination() == wire::kBroadcast;
  Verdict verdict = memory_.verdict(packet.source(), packet.code(), broadcast, at);
  if (verdict == Verdict::doubtful) return counted(counters_.doubtful_retries, packet.fbc());
  if (verdict == Verdict::none) {
    if (membership_.is_unaware_nodes_retry(packet, at)) return packet.fbc();
    verdict = pull(packet, at) ? Verdict::taken : Verdict::refused;
    memory_.remember(packet.source(), packet.code(), broadcast, verdict, at);
  } else {
    ++counters_.duplicates;
  }
  return std::min<std::uint8_t>(packet.fbc(), verdict == Verdict::taken ? 1 : 0);
}

bool Pins::pull(const wire::PacketFields& packet, Time at) {
  const wire::Factor factor = wire::factor_of(packet.last());
  if (!settings_.wired[factor]) return counted(counters_.refused_unwired, false);
  ++counters_.pins_pulled;
  events_.put(at, PinPulled{factor, packet.source()});
  return true;
}

}  // namespace limb_ring::core
