#pragma once

#include <cstdint>

namespace limb_ring::fault {

/// What the faults of a line have done to packets: (name, what one count means).
#define LIMB_RING_LINE_COUNTERS(X)                                                          \
  X(line_dropped, "packet dropped by a fault of the line")                                  \
  X(line_corrupted, "packet with one bit made wrong by a fault of the line")                \
  X(line_truncated, "DATP broken off by a fault of the line")                               \
  X(line_duplicated, "packet doubled by a fault of the line")                               \
  X(line_reordered, "packet discarded as late: a fault of the line put it behind the next") \
  X(line_aborted, "DATP broken off because an INTP inside it was late")                     \
  X(line_delayed, "packet made later by a fault of the line")                               \
  X(line_held, "packet that had to wait for a stall, a rate or one before it")              \
  X(line_full, "packet dropped whole: too much was held back")                              \
  X(line_cut, "packet lost because a fault had cut the line")                               \
  X(line_lost, "slice that was held back when its line was cut or replaced")

struct LineCounters {
#define LIMB_RING_LINE_COUNTER_MEMBER(name, meaning) std::uint64_t name = 0;
  LIMB_RING_LINE_COUNTERS(LIMB_RING_LINE_COUNTER_MEMBER)
#undef LIMB_RING_LINE_COUNTER_MEMBER

  /// Calls visit(name, meaning, value) for each, in the order above.
  template <class Visit>
  void each(Visit visit) const {
#define LIMB_RING_LINE_COUNTER_VISIT(name, meaning) visit(#name, meaning, name);
    LIMB_RING_LINE_COUNTERS(LIMB_RING_LINE_COUNTER_VISIT)
#undef LIMB_RING_LINE_COUNTER_VISIT
  }
};

}  // namespace limb_ring::fault
