#pragma once

#include "config/load_ring.h"

namespace limb_ring::bridge {

/// A body, a knee of one joint, and a hip of two with an IMU and a force sensor.
inline config::RingConfig small_robot() {
  return config::parse_ring(R"(
ring: small
nodes:
  - {id: 0, name: body, cpu: attached}
  - id: 7
    name: knee
    cpu: {command: [limb_firmware]}
    joints: [{name: knee_pitch}]
  - id: 3
    name: hip
    cpu: {command: [limb_firmware]}
    joints: [{name: hip_pitch}, {name: hip_roll}]
    sensors: [{name: hip_imu, kind: imu}, {name: hip_force, kind: force}]
)",
                            "small.yaml");
}

}  // namespace limb_ring::bridge
