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
/// Sets the flag *saturated* if a value is cut.
void put(ByteWriter& writer, const JointCommand::Joint& joint);
std::optional<DecodeError> get(ByteReader& reader, JointCommand::Joint& joint);
///@}

/// Numbers cross the ring as signed 32-bit multiples of a stated resolution (ours): exact to half
/// a step, the same on every machine, and never NaN.
///
///   joints: 1e-6 rad, rad/s, N m              range +-2147.483647
///   IMU:    1e-6 m/s^2, rad/s                 range +-2147.483647
///   force:  1e-5 N, N m                       range +-21474.83647 (a landing humanoid's foot)
///
/// A value that already is a multiple of the resolution comes out as the nearest double to that
/// decimal number; reading and writing again changes nothing.
constexpr double kMicro = 1e6;     ///< steps per unit
constexpr double kTenMicro = 1e5;  ///< steps per unit

/// A number as it crosses the ring.
struct Fixed {
  std::int32_t steps = 0;
  bool saturated = false;  ///< the value was out of range (infinite too) and was cut to it
};

/// The nearest step, halves away from zero.
/// @pre not NaN
Fixed to_fixed(double value, double steps_per_unit);

inline double from_fixed(std::int32_t steps, double steps_per_unit) { return steps / steps_per_unit; }

}  // namespace limb_ring::payload
