#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/ringctl/up.h"

namespace limb_ring::ringctl {

/// What a node still lacks, by its status row, before the ring of so many nodes counts as whole: it has to be up in a
/// ring of all of them, its second line, if it has one, to be connected, and its CPU to run where that is a child of
/// ringd. Empty where nothing.
std::string lack_of_node(const status::NodeRow& row, std::size_t nodes);
/// The same for one host's part of a ring, while other hosts may still be missing: the node has to be in a ring of at
/// least this host's `nodes`, or in an open chain.
std::string lack_in_part(const status::NodeRow& row, std::size_t nodes);

/// Watches a ring that is being started, over connections that it keeps.
class RingWatch {
 public:
  explicit RingWatch(const RingPlan& plan);

  struct NotReady {
    std::size_t index;  ///< of the node, in ring order
    std::string lack;   ///< "node 3 (left_knee): it is joining"
  };
  /// The first node that is not ready; nothing where the ring is closed.
  std::optional<NotReady> first_not_ready();
  /// How many nodes the ring had, as far as the nodes here knew when they were asked last.
  std::size_t ring_size() const { return ring_size_; }
  /// Why a node will never get into the ring, as any node told that answered last, behind "; "; empty if none said so.
  const std::string& refusal() const { return refusal_; }

 private:
  const RingPlan& plan_;
  ask::RingClient client_;
  std::size_t ring_size_ = 0;
  std::string refusal_;
};

}  // namespace limb_ring::ringctl
