#pragma once

#include <cstdint>
#include <vector>

#include "config/ring_config.h"
#include "limb_ring/payload/joint_command.h"
#include "tools/firmware/timestamps.h"

namespace limb_ring::firmware::bench {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

constexpr std::int64_t kWall = 1'700'000'000'000'000'000;

/// The instant `t` after the test's start, on both clocks.
inline Timestamps at(nanoseconds t) { return {50s + t, kWall + t.count()}; }

/// A limb with a knee that holds and an ankle that damps, an IMU at 50 Hz and a force sensor at
/// 10 Hz.
inline config::NodeConfig leg() {
  config::NodeConfig node;
  node.id = 12;
  node.name = "left_knee";
  node.joints.resize(2);
  node.joints[0].name = "l_knee";
  node.joints[1].name = "l_ankle_pitch";
  node.joints[1].safe = config::JointConfig::Safe::damp;
  node.sensors.resize(2);
  node.sensors[0].rate = 50;
  node.sensors[0].priority = 1;
  node.sensors[1].kind = config::SensorConfig::Kind::force;
  node.sensors[1].rate = 10;
  node.sensors[1].priority = 2;
  return node;
}

/// Positions for the first joints, given at `t`, valid for 100 ms.
inline payload::JointCommand positions(nanoseconds t, const std::vector<double>& values) {
  payload::JointCommand command;
  command.stamp_ns = at(t).wall_ns;
  command.valid_for_us = 100000;
  for (double value : values) {
    command.joints.emplace_back();
    command.joints.back().position = value;
  }
  return command;
}

inline Bytes bytes_of(const payload::JointCommand& command) { return *encode(command); }
inline payload::ByteView view(const Bytes& bytes) { return {bytes.data(), bytes.size()}; }

}  // namespace limb_ring::firmware::bench
