#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>

#include "runtime/clock.h"
#include "runtime/daemon_interrupts.h"
#include "watchdog/watchdog.h"

namespace limb_ring::runtime {

using watchdog::CpuSighting;
using watchdog::CpuVerdict;
using watchdog::WatchedCpu;
using watchdog::Watchdog;

/// What the ring's supervisor node does beside its own work: the watchdog, looked at once a beacon
/// period, its findings logged (a line each) and told, its orders given.
class RingSupervisor {
 public:
  using Found = std::function<void(const Watchdog::Finding&)>;

  RingSupervisor(boost::asio::io_context& io, const config::RingConfig& ring, const Clock& clock, DaemonInterrupts& interrupts,
                 Watchdog::SightingOf sighting_of, Found found);

  /// Does nothing where no CPU is to be watched, or the policy is off.
  void start();
  void stop() { timer_.cancel(); }
  const Watchdog& watchdog() const { return watchdog_; }

 private:
  void look_later();
  void look();
  void reset(wire::NodeId node);
  void tell(const Watchdog::Finding& finding) const;

  const config::RingConfig& ring_;
  const Clock& clock_;
  DaemonInterrupts& interrupts_;
  Watchdog::SightingOf sighting_of_;
  Found found_;
  Watchdog watchdog_;
  boost::asio::steady_timer timer_;
};

}  // namespace limb_ring::runtime
