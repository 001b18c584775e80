#include "ros_bridge/line_load.h"

#include <algorithm>

#include "ring/line_bytes.h"
#include "ros_bridge/counter_growth.h"

namespace limb_ring::bridge {
namespace {

constexpr double kShortest = 0.5;  // s between readings: a status at every change tells no rate

std::uint64_t bytes_in(const NodeStatus& node) {
  return ask::line_bytes_in([&node](const char* name) { return counter_of(node, name); });
}

}  // namespace

void LineLoad::take(const RingStatus& ring) {
  for (const NodeStatus& node : ring.nodes) {
    if (node.output_to >= 0) rates_[static_cast<std::uint8_t>(node.output_to)] = node.output_rate;
    const Count now{bytes_in(node), node.pid, ring.header.stamp};
    Count& before = counts_[node.id];
    const double seconds = (now.at - before.at).toSec();
    const bool goes_on = seconds >= 0 && now.pid == before.pid;  // not where a bag is played once more
    if (goes_on && seconds < kShortest) continue;
    if (goes_on && now.pid != 0 && now.bytes >= before.bytes)
      bytes_per_second_[node.id] = static_cast<double>(now.bytes - before.bytes) / seconds;
    else
      bytes_per_second_.erase(node.id);
    before = now;
  }
  busiest_ = 0;
  for (const auto& [end, bytes] : bytes_per_second_) busiest_ = std::max(busiest_, bytes);
}

std::optional<double> LineLoad::of(std::uint8_t end) const {
  const auto bytes = bytes_per_second_.find(end);
  if (bytes == bytes_per_second_.end()) return std::nullopt;
  const auto rate = rates_.find(end);
  if (rate != rates_.end() && rate->second > 0) return std::min(1.0, 8 * bytes->second / rate->second);
  return busiest_ > 0 ? bytes->second / busiest_ : 0;
}

}  // namespace limb_ring::bridge
