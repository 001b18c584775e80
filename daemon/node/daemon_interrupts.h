#pragma once

#include <functional>
#include <map>

#include "config/reset_order.h"
#include "node/cpu_sightings.h"
#include "node/node_driver.h"

namespace limb_ring::runtime {

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

}  // namespace limb_ring::runtime
