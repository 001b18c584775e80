#include "study/analysis/model_ring.h"

#include <stdexcept>

#include "study/analysis/ring_bounds.h"

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

}  // namespace limb_ring::study
