#include "study/analysis/latency.h"

#include <algorithm>
#include <cmath>

namespace limb_ring::study {

Duration Latencies::mean() const {
  if (values_.empty()) return Duration{0};
  long double sum = 0;
  for (const Duration value : values_) sum += static_cast<long double>(value.count());
  return Duration{static_cast<std::int64_t>(std::llround(sum / static_cast<long double>(values_.size())))};
}

Duration Latencies::quantile(double share) const {
  if (values_.empty()) return Duration{0};
  if (!sorted_) std::sort(values_.begin(), values_.end());
  sorted_ = true;
  return values_[statistics::nearest_rank(values_.size(), share)];
}

}  // namespace limb_ring::study
