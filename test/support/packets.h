#pragma once

#include <cstdint>
#include <vector>

#include "wire/packet.h"

namespace limb_ring::test {

/// A DATP as plain values. (protocol.md section 3)
struct DataPacket {
  wire::Code code;
  std::uint8_t hop = 0;
  wire::NodeId source{0};
  std::uint8_t fbc = wire::kFbcUntaken;
  wire::NodeId destination{0};
  std::uint8_t pri = 0;
  wire::ByteView data;  ///< 1..512 bytes, owned by someone else
};

/// An INTP as plain values.
struct InterruptPacket {
  wire::Code code{true};
  std::uint8_t hop = 0;
  wire::NodeId source{0};
  std::uint8_t fbc = wire::kFbcUntaken;
  wire::NodeId destination{0};
  wire::Factor factor{};
};

/// Its bytes with their CRC, put together apart from Flight, which does so in a node.
inline std::vector<std::uint8_t> encoded(const DataPacket& packet) {
  std::vector<std::uint8_t> bytes{packet.code.byte(), wire::kSop, packet.hop, packet.source};
  bytes.insert(bytes.end(), packet.data.begin(), packet.data.end());
  bytes.insert(bytes.end(), {wire::kEop, packet.fbc, packet.destination, packet.pri});
  const std::uint32_t crc = wire::crc32({bytes.data(), bytes.size()});
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(crc >> shift));
  return bytes;
}

inline std::vector<std::uint8_t> encoded(const InterruptPacket& packet) {
  return encoded(DataPacket{packet.code, packet.hop, packet.source, packet.fbc, packet.destination, packet.factor, {}});
}

}  // namespace limb_ring::test
