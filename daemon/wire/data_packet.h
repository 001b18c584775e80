#pragma once

#include "wire/packet.h"

namespace limb_ring::wire {

/// DATP, a data packet (paper; see packet.h for what the fields mean):
///
///   | Code | SOP | HOP | SID | Data 1..512 B | EOP | FBC | DID | PRI | CRC 4 B |
///
/// PRI: bits 1..0 priority, 0 the highest (paper); bits 7..2 channel (ours).
constexpr std::size_t kMaxPayload = 512;
constexpr std::size_t kMinDataPacketSize = kOverhead + 1;
constexpr std::size_t kMaxDataPacketSize = kOverhead + kMaxPayload;

/// Channels of the PRI field. (ours)
enum class Channel : std::uint8_t { user = 0, control = 1, joint = 2, fragment = 3 };

constexpr ChannelId id_of(Channel channel) { return ChannelId{static_cast<std::uint8_t>(channel)}; }

inline std::uint8_t pri_byte(Priority priority, ChannelId channel) {
  return static_cast<std::uint8_t>(channel << 2 | (priority & 3));
}
inline Priority priority_of(std::uint8_t pri) { return Priority{static_cast<std::uint8_t>(pri & 3)}; }
inline ChannelId channel_of(std::uint8_t pri) { return ChannelId{static_cast<std::uint8_t>(pri >> 2)}; }

/// True for a DATP on the network controllers' own channel.
inline bool is_control(const PacketFields& packet) { return channel_of(packet.last()) == id_of(Channel::control); }

/// A DATP as a plain value.
struct DataPacket {
  Code code;
  std::uint8_t hop = 0;
  NodeId source{0};
  std::uint8_t fbc = kFbcUntaken;
  NodeId destination{0};
  std::uint8_t pri = 0;
  ByteView data;  ///< 1..512 bytes, owned by someone else
};

/// Writes the packet with its CRC. @pre 1 <= data.size <= 512; `out` has room for data.size + 12.
/// @return bytes written
std::size_t encode(const DataPacket& packet, std::uint8_t* out);

/// Reads a packet; `packet.data` points into `bytes`.
/// @return PacketError::none where everything (CRC included) is right
PacketError decode(ByteView bytes, DataPacket& packet);

}  // namespace limb_ring::wire
