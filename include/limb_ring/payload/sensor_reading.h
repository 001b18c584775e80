#pragma once

#include <array>
#include <cstdint>

#include "limb_ring/payload/byte_view.h"
#include "limb_ring/payload/expected.h"

namespace limb_ring::payload {

/// One sample of an IMU or of a force and torque sensor, from a CPU to the body, on channel 2.
/// (ours)
///
///    0      1         2          4                12       13      14     16        28
///   | type | version | sequence | stamp           | sensor | flags | zero | linear  | angular |
///   | 8    | 8       | 16       | 64, signed, ns  | 8      | 8     | 16   | 3 x i32 | 3 x i32 |
///
///   type 3, imu:   acceleration in 1e-6 m/s^2, angular velocity in 1e-6 rad/s
///   type 4, force: force in 1e-5 N, torque in 1e-5 N m
///   flags: bit 0 saturated
struct SensorReading {
  enum class Kind : std::uint8_t { imu = 3, force = 4 } kind = Kind::imu;
  std::uint16_t sequence = 0;       ///< +1 for every reading of this sensor, wraps
  std::int64_t stamp_ns = 0;        ///< CLOCK_REALTIME when sampled, ns since 1970, not negative
  std::uint8_t sensor = 0;          ///< its place in the node's configured sensors, from 0
  bool saturated = false;           ///< read only: a value was out of range and cut to it
  std::array<double, 3> linear{};   ///< x, y, z: m/s^2 or N
  std::array<double, 3> angular{};  ///< x, y, z: rad/s or N m
};

/// @return EncodeFailure naming the axis (0 to 2 linear, 3 to 5 angular)
Encoded encode(const SensorReading& reading);
/// Takes either kind.
Decoded<SensorReading> decode_sensor_reading(ByteView packet);

}  // namespace limb_ring::payload
