#pragma once

#include <cstdint>
#include <functional>
#include <map>

#include "config/ring_config.h"
#include "config/watchdog.h"
#include "node/cpu_socket.h"
#include "node/node_driver.h"

namespace limb_ring::runtime {

/// What the interrupt pins of this node drive. (paper: pins; the actions are ours)
class PinBoard {
 public:
  PinBoard(const config::Pins& pins, CpuSocket& cpu) : pins_(pins), cpu_(cpu) {}

  /// Pin `factor` was pulled by node `source`; `clock_ns` is when.
  /// @return what was done, for people
  std::string pull(std::uint8_t factor, std::uint8_t source, std::int64_t clock_ns);
  /// By a sync pin. Known here at once, to the other nodes by the next beacon.
  void latch(std::uint8_t source, std::int64_t clock_ns);
  const wire::ClockLatch& last_latch() const { return latch_; }

 private:
  const config::Pins& pins_;
  CpuSocket& cpu_;
  wire::ClockLatch latch_;  ///< the last one
};

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

/// Interrupts that the daemon itself sends, for its clients and for the watchdog, and the resets that wait for the
/// effect of such an interrupt.
class DaemonInterrupts {
 public:
  using Ended = std::function<void(const core::SendEnded&)>;
  using ResetDone = std::function<void(const watchdog::ResetReport&)>;

  DaemonInterrupts(NodeDriver& driver, const CpuSightings& cpus) : driver_(driver), cpus_(cpus) {}

  void interrupt(wire::NodeId to, std::uint8_t factor, Ended done);
  /// So many resets for clients at a time.
  static constexpr std::size_t kMostResets = 64;
  bool has_room_for_reset() const { return resets_.size() < kMostResets; }
  /// Pulls the reset pin of `node`. `done` is called when the effect is known, or after `timeout`.
  void reset(wire::NodeId node, std::uint8_t factor, std::chrono::milliseconds timeout, ResetDone done);

  void on_ended(const core::SendEnded& ended);
  /// Something new is known of a node's CPU.
  void on_cpu_changed(wire::NodeId node);
  void stop();

 private:
  struct Reset {
    Reset(wire::NodeId n, const watchdog::CpuKnown& before, core::Time now, ResetDone d)
        : node(n), order(before, now), done(std::move(d)) {}
    wire::NodeId node;
    watchdog::ResetOrder order;
    ResetDone done;
    std::unique_ptr<event_loop::Timer> deadline;
  };
  /// By number, since the interrupt of a reset that has timed out may end while later ones are under way.
  using Resets = std::map<std::uint32_t, Reset>;

  /// @param report how the reset ended; none: it is still under way, and nothing is done
  void finish(Resets::iterator place, const watchdog::ResetOrder::Report& report);

  NodeDriver& driver_;
  const CpuSightings& cpus_;
  std::uint32_t last_token_ = 0;
  std::map<std::uint32_t, Ended> interrupts_;
  std::uint32_t last_reset_ = 0;
  Resets resets_;
};

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

  /// Does nothing if no CPU is to be watched, or the policy is off.
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
