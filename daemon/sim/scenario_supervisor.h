#pragma once

#include <list>

#include "config/reset_order.h"
#include "config/ring_config.h"
#include "config/watchdog.h"
#include "sim/cpus.h"
#include "sim/virtual_ring.h"

namespace limb_ring::scenario {

/// The ring's supervisor under a virtual clock: the watchdog of the daemon, evaluated once a beacon period, and its
/// orders given. Nodes are places in ring order. As in a live scenario every CPU is a child that has promised to speak,
/// so all are watched, and the supervisor is the configured node, else the first.
class Supervisor {
 public:
  /// All must outlive this. Does nothing unless the ring's policy is auto: a mere report changes nothing.
  Supervisor(const config::RingConfig& config, sim::VirtualRing& ring, const Cpus& cpus);
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// From now on. @pre not started yet
  void start();
  /// A node's daemon was started again. If it is the supervisor, it has forgotten all.
  void started(NodeId id);
  /// To be called for each event of the ring.
  void came(const core::Event& event, NodeId at);

 private:
  struct Reset {
    NodeId node;
    std::uint32_t token;
    watchdog::ResetOrder order;
  };

  void evaluate();
  void evaluate_later();
  void reset(NodeId id);
  /// @param report how the reset ended; none: it goes on
  void finish(std::list<Reset>::iterator reset, const watchdog::ResetOrder::Report& report);
  watchdog::CpuSighting sighting_of(NodeId id) const;
  watchdog::CpuKnown cpu_of(NodeId id) const;
  watchdog::Watchdog fresh() const;

  const config::RingConfig& config_;
  sim::VirtualRing& ring_;
  const Cpus& cpus_;
  core::Duration beacon_;
  NodeId node_;
  const core::Membership* membership_;  ///< of that node since its last start, read without waking the node
  watchdog::Watchdog watchdog_;
  std::list<Reset> resets_;
};

}  // namespace limb_ring::scenario
