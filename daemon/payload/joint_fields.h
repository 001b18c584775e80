#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "limb_ring/payload/joint_command.h"
#include "payload/byte_stream.h"

namespace limb_ring::payload {

/// @name The joints of commands: a mask, then the values whose bits are set
///@{
constexpr std::size_t kCommandFlagsAt = 16;
constexpr std::uint8_t kResume = 1 << 0;
constexpr std::uint8_t kCommandSaturated = 1 << 1;

bool has_nan(const JointCommand::Joint& joint);
std::size_t encoded_size(const JointCommand::Joint& joint);
/// Sets the flag *saturated* where a value is cut.
void put(ByteWriter& writer, const JointCommand::Joint& joint);
std::optional<DecodeError> get(ByteReader& reader, JointCommand::Joint& joint);
///@}

}  // namespace limb_ring::payload
