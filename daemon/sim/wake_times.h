#pragma once

#include <algorithm>
#include <vector>

#include "core/time.h"

namespace limb_ring::sim {

using core::Time;

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

}  // namespace limb_ring::sim
