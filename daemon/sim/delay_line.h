#pragma once

#include <vector>

#include "core/line.h"
#include "core/time.h"
#include "wire/packet.h"
#include "wire/slice.h"

namespace limb_ring::sim {

using core::Duration;
using core::Time;
using wire::NodeId;

/// What is under way on all lines of one relay delay. What leaves first arrives first, so a queue
/// is enough where a heap would cost ten times as much. Buffers of slices are swapped in and out,
/// never copied.
class DelayLine {
 public:
  struct Arrival {
    Time at{};
    NodeId from{0}, to{0};
    std::uint64_t epoch = 0;  ///< of the line it left on
    core::Line line = core::Line::first;
    wire::SliceWriter slices;

    template <class Archive>
    void archive(Archive& a) {
      a("at", at)("from", from)("to", to)("line", line)("slices", slices);
    }
  };

  explicit DelayLine(Duration delay) : delay_(delay), slots_(16), mask_(slots_.size() - 1) {}

  Duration delay() const { return delay_; }
  bool empty() const { return count_ == 0; }
  /// When the next one arrives, kNever where none is under way.
  Time next() const { return empty() ? core::kNever : slots_[first_].at; }
  /// What leaves at `now`; takes `slices`, and leaves an empty one in its place.
  void put(Time now, NodeId from, NodeId to, std::uint64_t epoch, core::Line line, wire::SliceWriter& slices) {
    if (count_ == slots_.size()) grow();
    Arrival& slot = slots_[(first_ + count_++) & mask_];
    slot.at = now + delay_;
    slot.from = from;
    slot.to = to;
    slot.epoch = epoch;
    slot.line = line;
    slot.slices.clear();
    slot.slices.swap(slices);
  }
  /// All that are under way, in their order.
  template <class Visit>
  void each(Visit visit) {
    for (std::size_t i = 0; i < count_; ++i) visit(slots_[(first_ + i) & mask_]);
  }
  /// The next one; valid until the next put(). @pre !empty()
  const Arrival& pop() {
    const Arrival& slot = slots_[first_];
    first_ = (first_ + 1) & mask_;
    --count_;
    return slot;
  }

 private:
  void grow() {
    std::vector<Arrival> larger(2 * slots_.size());
    for (std::size_t i = 0; i < count_; ++i) std::swap(larger[i], slots_[(first_ + i) & mask_]);
    slots_.swap(larger);
    mask_ = slots_.size() - 1;
    first_ = 0;
  }

  Duration delay_;
  std::vector<Arrival> slots_;  ///< a power of two
  std::size_t mask_;            ///< slots_.size() - 1
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace limb_ring::sim
