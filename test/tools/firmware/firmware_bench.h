#pragma once

#include <cstdint>
#include <vector>

#include "client/command_filter.h"
#include "client/node_cpu.h"
#include "limb_ring/payload/joint_command.h"
#include "tools/firmware/simulated_limb.h"

namespace limb_ring::firmware::bench {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

constexpr std::int64_t kWall = 1'700'000'000'000'000'000;

/// The instant `t` after the test's start, on both clocks.
inline Timestamps at(nanoseconds t) { return {50s + t, kWall + t.count()}; }

/// A limb with a knee that holds and an ankle that damps, an IMU at 50 Hz and a force sensor at
/// 10 Hz.
inline NodeSetup leg() {
  NodeSetup setup;
  setup.id = 12;
  setup.name = "left_knee";
  setup.command_timeout = 200ms;
  setup.state_to = 3;
  const NodeJoint joint{"l_knee", false, -3.14, 3.14, 6, 50, 0, false};
  setup.joints = {joint, joint};
  setup.joints[1].name = "l_ankle_pitch";
  setup.joints[1].damps = true;
  setup.sensors = {{"imu", true, 50, 1}, {"force", false, 10, 2}};
  return setup;
}

/// One joint, simulated as limb_firmware does.
struct SimulatedJoint {
  explicit SimulatedJoint(bool damps) : SimulatedJoint(setup_of(damps)) {}

  void command(const payload::JointCommand::Joint& joint, nanoseconds t) {
    payload::JointCommand command;
    command.stamp_ns = at(t).wall_ns;
    command.valid_for_us = 100000;
    command.joints = {joint};
    limb.command(payload::Decoded<payload::JointCommand>(command), at(t));
  }
  void advance(nanoseconds t) { limb.advance(at(t).monotonic); }
  JointGoal::State state() const { return limb.goals()[0].state; }
  const payload::JointState::Joint& joint() const { return limb.joints()[0]; }

  Limb limb;
  SimulatedLimb servos;

 private:
  static NodeSetup setup_of(bool damps) {
    NodeSetup setup = leg();
    setup.joints.resize(1);
    setup.joints[0].damps = damps;
    setup.joints[0].initial = 0.25;
    return setup;
  }
  explicit SimulatedJoint(const NodeSetup& setup) : limb(setup, true, at(0ms).monotonic), servos(setup) {
    limb.moved_by([this](double dt, const std::vector<JointGoal>& goals) { return servos.step(dt, goals); });
  }
};

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
