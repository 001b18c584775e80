#pragma once

#include <vector>

#include "config/line_faults.h"

namespace limb_ring::runtime {

/// Breaks the line out of a node on purpose, and mends it. (ours)
class LineBreaker {
 public:
  virtual ~LineBreaker() = default;

  /// As in fault::LineFaults; in effect when they return. Cutting or mending the line may change the node's state.
  virtual fault::LineFaults::Id begin(const fault::Fault& fault, core::Time now) = 0;
  virtual bool remove(fault::LineFaults::Id id, core::Time now) = 0;
  virtual void clear(core::Time now) = 0;
  virtual std::vector<fault::LineFaults::Listed> list(core::Time now) = 0;
  virtual const fault::LineCounters& counters() const = 0;
  /// Nothing more to wait for: the output is connected, or another fault keeps it from that.
  virtual bool mended() const = 0;
};

}  // namespace limb_ring::runtime
