#pragma once

#include <limb_ring/NodeStatus.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "ring/error_counters.h"

namespace limb_ring::bridge {

/// Value of a counter of a node's daemon; 0 where it has none of that name.
std::uint64_t counter_of(const NodeStatus& node, const std::string& name);

/// By how much the error counters of a node, or of a line at it, have grown from one status to the next. A daemon that
/// was restarted (another pid) counts from 0.
class CounterGrowth {
 public:
  explicit CounterGrowth(ask::ErrorCounter::Of of);

  struct Step {
    std::string name;
    std::uint64_t by, now;
  };
  /// Those that have grown since the last call; none at the first.
  std::vector<Step> take(const NodeStatus& node);
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::string> names_;
  std::map<std::string, std::uint64_t> last_;
  std::int32_t pid_ = 0;
};

}  // namespace limb_ring::bridge
