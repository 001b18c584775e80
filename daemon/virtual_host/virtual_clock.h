#pragma once

#include "event_loop/node_clock.h"
#include "sim/virtual_ring.h"

namespace limb_ring::virtual_host {

/// The clock of a virtual ring, counted from its start, for what else goes by the machine's.
class VirtualClock final : public event_loop::NodeClock {
 public:
  /// @param ring outlives this and its timers
  explicit VirtualClock(sim::VirtualRing& ring) : ring_(ring) {}

  /// Called where a timer has run out.
  std::function<void()> on_expired = [] {};

  /// Rounded up: who waits until then finds that it has come.
  static Time at(core::Time when);
  static core::Time ring_time(Time when) { return core::Time{} + when.time_since_epoch(); }

  Time now() const override;
  std::int64_t wall_ns(Time when) override { return when.time_since_epoch().count(); }
  /// Runs out in the ring's own time, before any node acts in that instant.
  std::unique_ptr<event_loop::Timer> timer(std::function<void()> on_time) override;

 private:
  sim::VirtualRing& ring_;
};

}  // namespace limb_ring::virtual_host
