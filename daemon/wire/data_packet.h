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

}  // namespace limb_ring::wire
