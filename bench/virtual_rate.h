#pragma once

#include <cstdint>

#include "bench/setup.h"
#include "ring/private_folder.h"

namespace limb_ring::bench {

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
