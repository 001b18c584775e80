#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/packet_type.h"

namespace limb_ring::firmware {

/// What a packet on the joint channel commands that node to do, or why it cannot be read; nothing: it is no command, or
/// one of other nodes.
inline std::optional<payload::Decoded<payload::JointCommand>> command_for(std::uint8_t node, payload::ByteView packet) {
  using payload::PacketType;
  if (payload::is_type(packet, PacketType::joint_command)) return payload::decode_joint_command(packet);
  if (!payload::is_type(packet, PacketType::command_set)) return std::nullopt;
  const auto set = payload::decode_command_set(packet);
  if (!set) return payload::Decoded<payload::JointCommand>(set.error());
  auto command = set->to(node);
  if (!command) return std::nullopt;
  return payload::Decoded<payload::JointCommand>(std::move(*command));
}

}  // namespace limb_ring::firmware
