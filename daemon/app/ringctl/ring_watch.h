#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/ringctl/ring_plan.h"

namespace limb_ring::ringctl {

/// What a node still lacks before the ring counts as closed: state up, a ring of all nodes, and
/// its CPU running where that is a child of ringd. Empty where nothing.
std::string missing(const PlannedNode& planned, const nlohmann::json& status, std::size_t nodes);

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

 private:
  std::string lack_of(std::size_t index);

  const RingPlan& plan_;
  std::vector<std::optional<HostPort>> ports_;
};

}  // namespace limb_ring::ringctl
