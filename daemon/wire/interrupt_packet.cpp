#include "wire/interrupt_packet.h"

namespace limb_ring::wire {

InterruptBytes encode(const InterruptPacket& packet) {
  InterruptBytes out{packet.code.byte(),
                     kSop,
                     packet.hop,
                     packet.source,
                     kEop,
                     packet.fbc,
                     packet.destination,
                     static_cast<std::uint8_t>(packet.factor & 7)};
  store_u32(out.data() + 8, crc32({out.data(), 8}));
  return out;
}

PacketError decode(ByteView bytes, InterruptPacket& packet) {
  const PacketError error = check_packet(bytes, true);
  if (error != PacketError::none) return error;
  const PacketFields f{bytes};
  if (f.last() >= kFactors) return PacketError::trailer;
  packet = {f.code(), f.hop(), f.source(), f.fbc(), f.destination(), factor_of(f.last())};
  return PacketError::none;
}

}  // namespace limb_ring::wire
