#pragma once

#include "config/reset_order.h"
#include "config/watchdog.h"
#include "node/cpu_socket.h"
#include "node/node_driver.h"

namespace limb_ring::runtime {

/// What this node knows of the CPUs of the ring: of its own by itself, of the others by their beacons.
class CpuSightings {
 public:
  /// All must outlive this.
  CpuSightings(const config::RingConfig& ring, const config::NodeConfig& self, const NodeDriver& driver,
               const CpuSocket& own)
      : ring_(ring), self_(self), driver_(driver), own_(own) {}

  /// For the watchdog.
  watchdog::CpuSighting of(wire::NodeId node) const;
  /// For a reset.
  watchdog::CpuKnown known(wire::NodeId node) const;

 private:
  const config::RingConfig& ring_;
  const config::NodeConfig& self_;
  const NodeDriver& driver_;
  const CpuSocket& own_;
};

}  // namespace limb_ring::runtime
