#pragma once

#include <vector>

#include "judge/percentiles.h"

namespace limb_ring::study {

using core::Duration;

/// Latencies of one kind, all kept.
class Latencies {
 public:
  void add(Duration latency) {
    values_.push_back(latency);
    sorted_ = false;
  }
  std::size_t count() const { return values_.size(); }
  /// @name Zero where there is none.
  ///@{
  Duration min() const { return quantile(0); }
  Duration max() const { return quantile(1); }
  Duration mean() const;
  /// The smallest value that at least this share of all does not exceed (nearest rank).
  Duration quantile(double share) const;
  ///@}
  const std::vector<Duration>& values() const { return values_; }

 private:
  mutable std::vector<Duration> values_;
  mutable bool sorted_ = true;
};

using statistics::microseconds;

}  // namespace limb_ring::study
