#pragma once

#include <cstdint>

namespace limb_ring::payload {

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
