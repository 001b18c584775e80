#include "core/transmit/returns.h"

namespace limb_ring::core {

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
