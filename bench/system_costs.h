#pragma once

namespace limb_ring::bench {

/// What the basic steps of a message between two processes cost on this machine, both on one core, in us.
struct SystemCosts {
  double system_call = 0;  ///< the smallest there is: getppid()
  double process_switch =
      0;  ///< half of a byte's way through pipes to another process and back: one switch, two system calls
};

/// Takes about a tenth of a second for each. @throw std::runtime_error
SystemCosts measure_system_costs();

}  // namespace limb_ring::bench
