#pragma once

#include <cstdint>
#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/measurement.h"
#include "bench/setup.h"
#include "io/program.h"
#include "ring/launched_ring.h"

namespace limb_ring::bench {

struct RelayChainResult {
  std::string skipped;  ///< why; empty if it was measured
  Measurement measured;
};

/// What the same job takes with ROS alone: as many topic_tools/relay nodes in a chain, closed to a
/// ring by one node (relay_chain_ends) that publishes into it and subscribes to its end, with one
/// message outstanding. Has a ROS master of its own.
RelayChainResult measure_relay_chain(const Setup& setup, const live::PrivateFolder& folder, Pinning pinning);

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
  std::string skipped;  ///< why; empty if it was measured
  OwnRate measured;
};

/// @throw std::runtime_error
OwnRateResult measure_own_rate(const Setup& setup, const live::PrivateFolder& folder);

/// Programs of ROS with a master of their own; they end with this object.
class RosPrograms {
 public:
  /// Starts the master. @throw std::runtime_error if it cannot
  RosPrograms(const Setup& setup, const live::PrivateFolder& folder);
  ~RosPrograms();
  RosPrograms(const RosPrograms&) = delete;
  RosPrograms& operator=(const RosPrograms&) = delete;

  /// @return it; stays where it is. @throw std::runtime_error if there is no such program
  process::Program& start(const std::string& program, const std::vector<std::string>& arguments,
                          const std::optional<cpu_set_t>& cores = {});
  /// Waits until it has ended and reads the JSON it printed.
  /// @throw std::runtime_error with its last lines if it printed none, or takes longer than a minute
  nlohmann::json result_of(process::Program& program);

  /// Why a measurement that needs `own_program` and ROS cannot be made; empty if it can.
  static std::string missing(const Setup& setup, const std::string& own_program);

 private:
  const Setup& setup_;
  const live::PrivateFolder& folder_;
  std::string port_;
  std::deque<process::Program> programs_;
};

}  // namespace limb_ring::bench
