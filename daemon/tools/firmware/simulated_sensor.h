#pragma once

#include <cstdint>

#include "config/ring_config.h"
#include "limb_ring/payload/sensor_reading.h"
#include "tools/firmware/limb.h"
#include "tools/firmware/periodic.h"

namespace limb_ring::firmware {

/// A sensor at the end of the limb, made up from its joints (ours): plausible, repeatable, and
/// moving when they move. Not a model of the body's dynamics.
///
///   imu:    gravity seen from a link pitched by the sum of the joints' angles, and their summed
///           velocity as turn rate about y; joints that slide do not pitch it
///   force:  the torque of the last joint about y, and its force over a lever of 0.4 m along z; of one that slides its
///           force alone
class SimulatedSensor {
 public:
  SimulatedSensor(const config::SensorConfig& sensor, std::uint8_t index, nanoseconds start);

  nanoseconds due() const { return periodic_.due(); }
  std::optional<Periodic::Due> take(nanoseconds now) { return periodic_.take(now); }
  /// The reading at `now`, under the next sequence number.
  payload::SensorReading sample(const Limb& limb, const Timestamps& now);
  /// So many samples are not taken: their sequence numbers stay unused, so the receiver knows.
  void leave_out(std::uint64_t samples) { sequence_ = static_cast<std::uint16_t>(sequence_ + samples); }
  std::uint8_t priority() const { return priority_; }
  std::uint64_t left_out() const { return periodic_.left_out(); }

 private:
  config::SensorConfig::Kind kind_;
  std::uint8_t priority_;
  std::uint8_t index_;
  std::uint16_t sequence_ = 0;
  Periodic periodic_;
};

}  // namespace limb_ring::firmware
