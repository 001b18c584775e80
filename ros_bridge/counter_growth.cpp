#include "ros_bridge/counter_growth.h"

#include <algorithm>

namespace limb_ring::bridge {

std::uint64_t counter_of(const NodeStatus& node, const std::string& name) {
  const auto& names = node.counter_names;
  const auto place = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  return place < node.counter_values.size() ? node.counter_values[place] : 0;
}

CounterGrowth::CounterGrowth(ask::ErrorCounter::Of of) {
  for (const ask::ErrorCounter& counter : ask::error_counters())
    if (counter.of == of) names_.push_back(counter.name);
}

std::vector<CounterGrowth::Step> CounterGrowth::take(const NodeStatus& node) {
  std::vector<Step> grown;
  if (node.pid == 0) return grown;  // nobody says
  const bool first = pid_ == 0, restarted = node.pid != pid_;
  pid_ = node.pid;
  for (const std::string& name : names_) {
    const std::uint64_t now = counter_of(node, name);
    const std::uint64_t before = restarted ? 0 : last_[name];
    if (!first && now > before) grown.push_back({name, now - before, now});
    last_[name] = now;
  }
  return grown;
}

}  // namespace limb_ring::bridge
