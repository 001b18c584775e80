#pragma once

#include <vector>

#include "support/packets.h"
#include "support/view.h"
#include "wire/packet_assembler.h"

namespace limb_ring::test {

using Bytes = std::vector<std::uint8_t>;

/// A DATP with a good CRC; its payload counts up from 0.
inline Bytes data_packet(std::uint8_t source, std::uint8_t destination, std::size_t size = 8, std::uint8_t pri = 2,
                         wire::Code code = {}) {
  Bytes payload(size);
  for (std::size_t i = 0; i < size; ++i) payload[i] = static_cast<std::uint8_t>(i);
  DataPacket packet;
  packet.code = code;
  packet.source = wire::NodeId{source};
  packet.destination = wire::NodeId{destination};
  packet.pri = pri;
  packet.data = view(payload);
  return encoded(packet);
}

inline Bytes interrupt_packet(std::uint8_t source, std::uint8_t destination, std::uint8_t factor) {
  InterruptPacket packet;
  packet.source = wire::NodeId{source};
  packet.destination = wire::NodeId{destination};
  packet.factor = wire::Factor{factor};
  return encoded(packet);
}

}  // namespace limb_ring::test
