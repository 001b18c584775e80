#pragma once

#include <limb_ring/RingStatus.h>

#include <cstdint>
#include <map>
#include <optional>

namespace limb_ring::bridge {

/// What the lines carry, from one status to the next. A line is named by the node at its end, which
/// counts what came in.
class LineLoad {
 public:
  void take(const RingStatus& ring);

  /// 0 (idle) to 1: share of the line's data rate; where it has none, of the busiest line. Nothing
  /// where it cannot be known.
  std::optional<double> of(std::uint8_t end) const;

 private:
  struct Count {
    std::uint64_t bytes = 0;
    std::int32_t pid = 0;
    ros::Time at;
  };
  std::map<std::uint8_t, Count> counts_;
  std::map<std::uint8_t, double> bytes_per_second_, rates_;
  double busiest_ = 0;
};

}  // namespace limb_ring::bridge
