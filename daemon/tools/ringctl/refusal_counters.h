#pragma once

#include "limb_ring/host_port.h"
#include "ring/status_rows.h"

namespace limb_ring::ringctl {

/// Refusals as counted by the destinations' own daemons, if these run on this host. They know the reason, which the
/// source can only infer from beacons.
class RefusalCounters {
 public:
  /// @param before their status rows from before the sends
  explicit RefusalCounters(ask::Rows before) : before_(std::move(before)) {}

  /// Replaces the reason of each refused result by the destinations' own, if exactly one reason was counted since.
  /// @param now rows of the same nodes, after the sends
  void explain(std::vector<Result>& results, const std::vector<ask::Node>& nodes, const ask::Rows& now) const;

 private:
  ask::Rows before_;
};

}  // namespace limb_ring::ringctl
