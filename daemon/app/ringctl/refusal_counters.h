#pragma once

#include <map>

#include "ask/status_rows.h"
#include "limb_ring/host_port.h"

namespace limb_ring::ringctl {

/// What the destinations' own daemons have counted as refused, where they can be asked on this host. What the source
/// only infers from beacons, they know.
class RefusalCounters {
 public:
  /// @param before their status rows from before the sends
  explicit RefusalCounters(ask::Rows before) : before_(std::move(before)) {}

  /// The reason of a refused result is the destinations' own, where exactly one reason has been counted since.
  /// @param now rows of the same nodes, after the sends
  void explain(std::vector<Result>& results, const std::vector<ask::Node>& nodes, const ask::Rows& now) const;

 private:
  ask::Rows before_;
};

}  // namespace limb_ring::ringctl
