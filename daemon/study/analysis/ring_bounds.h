#pragma once

#include "study/analysis/medium.h"
#include "wire/interrupt_packet.h"

namespace limb_ring::study {

// What our ring promises while nothing is lost. (protocol.md section 7.2)

/// T: a whole DATP of the medium's payload on the line.
inline Duration packet_time(const Medium& medium) {
  return medium.byte_time() * static_cast<std::int64_t>(medium.payload + wire::kOverhead);
}

/// An INTP on the line.
inline Duration interrupt_time(const Medium& medium) {
  return medium.byte_time() * static_cast<std::int64_t>(wire::kInterruptPacketSize);
}

/// A DATP, from the start of sending until its tail is in so many hops further, where no INTP is under
/// way: h (T + d).
inline Duration data_bound(const Medium& medium, unsigned hops) {
  return hops * (packet_time(medium) + medium.relay_delay);
}

/// An INTP, from the CPU's request until it is back: at every node behind one INTP of its own and the
/// odd bytes, trailer and CRC of a DATP. All DATPs have the medium's payload.
inline Duration interrupt_bound(const Medium& medium) {
  const std::size_t tail = wire::tail_size(wire::kOverhead + medium.payload);
  const Duration wait = medium.byte_time() * static_cast<std::int64_t>(tail);
  return medium.nodes * (medium.relay_delay + interrupt_time(medium) + wait);
}

/// The same where INTPs are not embedded: at every node behind a whole DATP instead. (ours)
inline Duration interrupt_bound_between_packets(const Medium& medium) {
  return medium.nodes * (medium.relay_delay + interrupt_time(medium) + packet_time(medium));
}

}  // namespace limb_ring::study
