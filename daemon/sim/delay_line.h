#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
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
  /// When the next one arrives, kNever if none is under way.
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

/// When each node wants to be woken, and the earliest of them: a tree of minima, so that one node's
/// new time costs the logarithm of their number.
class WakeTimes {
 public:
  explicit WakeTimes(unsigned nodes) : leaves_(1) {
    while (leaves_ < nodes) leaves_ *= 2;
    tree_.assign(2 * leaves_, core::kNever);
  }

  Time earliest() const { return tree_[1]; }
  Time operator[](unsigned node) const { return tree_[leaves_ + node]; }
  void set(unsigned node, Time at) {
    std::size_t i = leaves_ + node;
    if (tree_[i] == at) return;
    tree_[i] = at;
    while (i > 1) {
      i /= 2;
      const Time least = std::min(tree_[2 * i], tree_[2 * i + 1]);
      if (tree_[i] == least) return;
      tree_[i] = least;
    }
  }
  /// Calls visit(node) for the nodes to be woken at that very time, lowest first; it may set().
  template <class Visit>
  void each_at(Time at, Visit visit) const {
    visit_below(1, at, visit);
  }

 private:
  template <class Visit>
  void visit_below(std::size_t i, Time at, Visit& visit) const {
    if (tree_[i] > at) return;
    if (i >= leaves_) return visit(static_cast<unsigned>(i - leaves_));
    visit_below(2 * i, at, visit);
    visit_below(2 * i + 1, at, visit);
  }

  std::size_t leaves_;
  std::vector<Time> tree_;  ///< [1] the root, children of i at 2i and 2i + 1
};

/// A set of nodes, given out lowest first.
class NodeSet {
 public:
  void insert(wire::NodeId id) { words_[id / 64] |= std::uint64_t{1} << (id % 64); }
  bool empty() const { return (words_[0] | words_[1] | words_[2] | words_[3]) == 0; }
  /// @pre !empty()
  wire::NodeId pop() {
    std::size_t word = 0;
    while (words_[word] == 0) ++word;
    const auto bit = static_cast<std::size_t>(__builtin_ctzll(words_[word]));
    words_[word] &= words_[word] - 1;
    return static_cast<wire::NodeId>(word * 64 + bit);
  }

 private:
  std::array<std::uint64_t, 4> words_{};
};

}  // namespace limb_ring::sim
