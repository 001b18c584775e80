#pragma once

#include <cstdint>
#include <string>

#include "bench/setup.h"
#include "ring/launched_ring.h"

namespace limb_ring::bench {

/// What the basic steps of a message between two processes cost on this machine, both on one core, in us.
struct SystemCosts {
  double system_call = 0;  ///< the smallest there is: getppid()
  double process_switch =
      0;  ///< half of a byte's way through pipes to another process and back: one switch, two system calls
};

/// Takes about a tenth of a second for each. @throw std::runtime_error
SystemCosts measure_system_costs();

/// Writes a copy of the humanoid's file with other rates.
/// @param state_rate Hz, of its limb nodes
/// @param bridge text for the beginning of the section `bridge`, such as "rate: 1000"
/// @return the copy's path
/// @throw std::runtime_error if the humanoid's file no longer has the text that is to be replaced
std::string write_humanoid(const Setup& setup, const live::PrivateFolder& folder, unsigned state_rate,
                           const std::string& bridge);

/// A humanoid on a virtual ring, as fast as the machine is: its nodes' firmware as processes and a controller, all in
/// lockstep on one core. All joints are commanded as often as they send their states.
struct VirtualRate {
  unsigned state_rate = 0;     ///< Hz, of the ring's time
  std::uint64_t samples = 0;   ///< that the nodes' CPUs were to send
  std::uint64_t left_out = 0;  ///< of those
  double times_real_time = 0;  ///< the ring's time by real time
};

/// @pre setup.humanoid is there
/// @throw std::runtime_error
VirtualRate measure_virtual_rate(const Setup& setup, const live::PrivateFolder& folder, unsigned state_rate);

}  // namespace limb_ring::bench
