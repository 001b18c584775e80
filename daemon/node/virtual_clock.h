#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "io/node_clock.h"
#include "sim/virtual_ring.h"

namespace limb_ring::virtual_host {

/// The clock of a virtual ring, counted from its start. At one of its nodes it takes the place of the machine's clock.
class VirtualClock final : public event_loop::NodeClock {
 public:
  /// @param ring outlives this, and this its timers
  /// @param on_expired called where a timer has run out
  explicit VirtualClock(
      sim::VirtualRing& ring, std::function<void()> on_expired = [] {})
      : ring_(ring), on_expired_(std::move(on_expired)) {}

  /// Rounded up to ns, so that a wait until then never ends early.
  static Time at(core::Time when);
  static core::Time ring_time(Time when) { return core::Time{} + when.time_since_epoch(); }

  Time now() const override;
  std::int64_t wall_ns(Time when) override { return when.time_since_epoch().count(); }
  /// Runs out in the ring's own time, before any node acts in that instant.
  std::unique_ptr<event_loop::Timer> timer(std::function<void()> on_time) override;
  /// Calls `call` once at `when`, as a timer would; it cannot be cancelled. Not called once this clock is gone.
  void call_at(core::Time when, std::function<void()> call);

  /// @name A frozen node: timers that run out meanwhile are called when it is thawed
  ///@{
  void freeze() { frozen_ = true; }
  void thaw();
  ///@}

 private:
  void due(const std::function<void()>& call);

  sim::VirtualRing& ring_;
  std::function<void()> on_expired_;
  bool frozen_ = false;
  std::vector<std::function<void()>> missed_;  ///< in the order in which they were due
  std::shared_ptr<VirtualClock*> self_ = std::make_shared<VirtualClock*>(this);
};

}  // namespace limb_ring::virtual_host
