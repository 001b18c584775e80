#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "client/byte_stream.h"
#include "limb_ring/payload/joint_command.h"

namespace limb_ring::payload {

/// What joint commands and command sets are made of: first a head, which both have.
struct CommandHead {
  std::uint16_t sequence = 0;
  std::int64_t stamp_ns = 0;
  std::uint32_t valid_for_us = 0;
  std::uint8_t flags = 0;
  std::uint8_t count = 0;  ///< of what follows
};
constexpr std::uint8_t kResume = 1 << 0;
constexpr std::uint8_t kCommandSaturated = 1 << 1;

void put(ByteWriter& writer, PacketType type, const CommandHead& head);
/// @param known flags that may be set
Decoded<CommandHead> get_head(ByteReader& reader, PacketType type, std::uint8_t known);

/// @name The joints: a mask, then the values whose bits are set
///@{
bool has_nan(const JointCommand::Joint& joint);
std::size_t encoded_size(const JointCommand::Joint& joint);
/// Sets the flag *saturated* where a value is cut.
void put(ByteWriter& writer, const JointCommand::Joint& joint);
std::optional<DecodeError> get(ByteReader& reader, JointCommand::Joint& joint);
///@}

}  // namespace limb_ring::payload
