#pragma once

#include <string>

#include "bench/measurement.h"
#include "bench/setup.h"
#include "ring/private_folder.h"

namespace limb_ring::bench {

struct RelayChainResult {
  std::string skipped;  ///< why; empty where it was measured
  Measurement measured;
};

/// What the same job takes with ROS alone: as many topic_tools/relay nodes in a chain, closed to a
/// ring by one node (relay_chain_ends) that publishes into it and subscribes to its end, with one
/// message outstanding. Has a ROS master of its own.
RelayChainResult measure_relay_chain(const Setup& setup, const live::PrivateFolder& folder, Pinning pinning);

}  // namespace limb_ring::bench
