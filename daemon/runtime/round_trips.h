#pragma once

#include <boost/circular_buffer.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/time.h"

namespace limb_ring::runtime {

double microseconds(core::Duration duration);

/// Exact percentiles of some durations, in microseconds.
struct Percentiles {
  double min = 0, p50 = 0, p99 = 0, max = 0;
  std::size_t samples = 0;
};
/// Reorders `samples`.
Percentiles percentiles(std::vector<core::Duration>& samples);

/// {"min","p50","p99","max","samples"}; null instead of numbers where there are no samples.
nlohmann::json to_json(const Percentiles& percentiles);

/// The round trips of a node's last 4096 sends.
class RoundTrips {
 public:
  static constexpr std::size_t kKept = 4096;
  void add(core::Duration round_trip) { last_.push_back(round_trip); }
  Percentiles get() const {
    std::vector<core::Duration> copy(last_.begin(), last_.end());
    return percentiles(copy);
  }

 private:
  boost::circular_buffer<core::Duration> last_{kKept};
};

}  // namespace limb_ring::runtime
