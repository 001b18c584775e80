#pragma once

#include <cstdint>
#include <string>

#include "bench/setup.h"
#include "ring/private_folder.h"

namespace limb_ring::bench {

/// A humanoid at a robot's own rate, 1 kHz: states and commands of all joints, and ring_bridge in ROS.
struct OwnRate {
  double joint_states_rate = 0;  ///< Hz, as a subscriber gets them
  double commands_rate = 0;      ///< Hz, as each node with joints takes them
  std::uint64_t samples = 0;     ///< that the nodes' CPUs were to send
  std::uint64_t left_out = 0;    ///< of those
  double lap_p50_us = 0;         ///< of the node for which it is worst
  double lap_p99_us = 0;
  double ring_percent = 0;  ///< of one core: daemons, firmware and bridge together
};

struct OwnRateResult {
  std::string skipped;  ///< why; empty where it was measured
  OwnRate measured;
};

/// @throw std::runtime_error
OwnRateResult measure_own_rate(const Setup& setup, const live::PrivateFolder& folder);

}  // namespace limb_ring::bench
