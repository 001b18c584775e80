#pragma once

#include <functional>

#include "config/watchdog.h"
#include "node/cpu_sightings.h"
#include "node/daemon_interrupts.h"

namespace limb_ring::runtime {

using watchdog::CpuVerdict;
using watchdog::Watchdog;
using watchdog::WatchedCpu;

/// What the ring's supervisor node does beside its own work: it polls the watchdog once a beacon period, logs and tells
/// its findings (a line each), and does the resets that it asks for.
class RingSupervisor {
 public:
  using Found = std::function<void(const Watchdog::Finding&)>;

  RingSupervisor(const config::RingConfig& ring, NodeDriver& driver, DaemonInterrupts& interrupts,
                 const CpuSightings& cpus, Found found);

  /// Does nothing where no CPU is to be watched, or the policy is off.
  void start();
  void stop() { timer_->cancel(); }
  const Watchdog& watchdog() const { return watchdog_; }

 private:
  void poll_later();
  void poll();
  void reset(wire::NodeId node);
  void tell(const Watchdog::Finding& finding) const;

  const config::RingConfig& ring_;
  NodeDriver& driver_;
  DaemonInterrupts& interrupts_;
  const CpuSightings& cpus_;
  Found found_;
  Watchdog watchdog_;
  std::unique_ptr<event_loop::Timer> timer_;
};

}  // namespace limb_ring::runtime
