#include "study/model_ring.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace limb_ring::study {
namespace {

constexpr core::Duration kNoLimit = std::chrono::hours(24 * 30);
constexpr unsigned kReceiveBuffers = 256;

}  // namespace

sim::VirtualRingOptions ring_options(const Medium& medium) {
  sim::VirtualRingOptions options;
  options.nodes = medium.nodes;
  options.byte_time = medium.byte_time();
  options.relay_delay = medium.relay_delay;
  options.keep_logs = false;
  options.adjust = [](core::Settings& settings) {
    settings.beacon = Duration{0};
    settings.send_timeout_least = Duration{0};
    settings.receive_buffers = kReceiveBuffers;
    settings.queue_timeout = settings.stall = settings.break_grace = settings.fold_permission = kNoLimit;
  };
  return options;
}

// VirtualRing::join() gives up after 10 s; on slow lines a lap alone takes longer.
void join(sim::VirtualRing& ring) {
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i)
    if (ring.join()) return;
  throw std::runtime_error("the virtual ring does not close");
}

void join_and_settle(sim::VirtualRing& ring, const Medium& medium) {
  join(ring);
  ring.run_for(data_bound(medium, medium.nodes));
}

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
