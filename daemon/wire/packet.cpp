#include "wire/packet.h"

#include "wire/data_packet.h"
#include "wire/interrupt_packet.h"

namespace limb_ring::wire {

const char* to_string(PacketError error) {
  switch (error) {
    case PacketError::none:
      return "good";
    case PacketError::size:
      return "a size no packet of its kind has";
    case PacketError::header:
      return "no valid header (kind, SOP or SID)";
    case PacketError::trailer:
      return "no EOP where the trailer should begin";
    case PacketError::crc:
      return "wrong CRC";
  }
  return "unknown";
}

PacketError check_packet(ByteView packet, bool interrupt) {
  const std::size_t least = interrupt ? kInterruptPacketSize : kMinDataPacketSize;
  const std::size_t most = interrupt ? kInterruptPacketSize : kMaxDataPacketSize;
  if (packet.size < least || packet.size > most) return PacketError::size;
  if (!header_valid(packet, interrupt)) return PacketError::header;
  if (!trailer_valid(packet)) return PacketError::trailer;
  return PacketFields{packet}.crc_good() ? PacketError::none : PacketError::crc;
}

}  // namespace limb_ring::wire
