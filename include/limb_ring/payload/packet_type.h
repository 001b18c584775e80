#pragma once

#include <cstdint>

#include "limb_ring/payload/byte_view.h"

namespace limb_ring::payload {

/// First byte of every packet on channels 2 and 3; the second is the version. (ours)
enum class PacketType : std::uint8_t {
  joint_state = 1,
  joint_command = 2,
  imu = 3,
  force = 4,
  command_set = 5,
  fragment = 16
};

constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kMaxPacket = 512;  ///< bytes of data in one packet (paper)

/// Channels of protocol.md section 3.6.
constexpr std::uint8_t kUserChannel = 0;
constexpr std::uint8_t kJointChannel = 2;
constexpr std::uint8_t kTopicChannel = 3;

/// Whether `packet` says that it is of this type. Says nothing about the rest.
inline bool is_type(ByteView packet, PacketType type) {
  return !packet.empty() && packet[0] == static_cast<std::uint8_t>(type);
}

}  // namespace limb_ring::payload
