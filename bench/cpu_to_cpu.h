#pragma once

#include "bench/measurement.h"
#include "bench/private_ring.h"
#include "ring/private_folder.h"

namespace limb_ring::bench {

/// Writes the configuration of a plain ring whose first node, and the one across, have CPUs that
/// connect from outside. @return its path
std::string write_two_cpus(const Setup& setup, const live::PrivateFolder& folder);

/// From one CPU to the other and back: two packets, each through both host ports, half a lap each
/// way. The CPUs are processes of their own. @pre `ring` was made from write_two_cpus()
Measurement measure_cpu_to_cpu(const Setup& setup, const PrivateRing& ring, Pinning pinning);

}  // namespace limb_ring::bench
