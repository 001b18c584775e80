#include "sim/mended_ring.h"

#include <algorithm>

namespace limb_ring::sim {

using core::Duration;
using namespace std::chrono_literals;

void set_short_times(core::Settings& settings, bool paced, bool fold_back) {
  settings.send_timeout_least = paced ? Duration{0} : Duration{100us};
  settings.refused_for = 2ms;
  settings.refused_backoff = 20us;
  settings.refused_backoff_most = 300us;
  settings.queue_timeout = 20ms;
  settings.stall = 50us;
  settings.beacon = 1ms;
  settings.break_grace = settings.fold_permission = 300us;
  settings.receive_buffers = 3;
  settings.send_queue = 6;
  settings.fold_back = fold_back;
  settings.wired = {true, false, true, true, true, true, true, true};
}

bool is_traffic(const wire::Slice& slice) {
  const bool control =
      slice.kind != wire::SliceKind::interrupt && slice.bytes.size >= 13 && slice.bytes[slice.bytes.size - 5] >> 2 == 1;
  return !control && slice.kind != wire::SliceKind::start;
}

void run_until_calm(VirtualRing& ring, const Invariants& invariants, const std::uint64_t& traffic,
                    const std::function<bool()>& asked_to_stop) {
  constexpr Duration kStep = 1ms, kLongest = 400ms;
  const core::Settings& settings = ring.settings(ring.order().front());
  const Duration pause = std::max(10 * settings.beacon, 5 * settings.send_timeout());
  Duration quiet{0};
  for (Duration waited{0}; waited < kLongest && quiet < pause && !asked_to_stop(); waited += kStep) {
    const std::uint64_t before = traffic;
    ring.run_for(kStep);
    const bool calm = traffic == before && invariants.all_ended() && !not_whole(ring);
    quiet = calm ? quiet + kStep : Duration{0};
  }
}

std::optional<Violation> not_whole(VirtualRing& ring) {
  for (const wire::NodeId id : ring.order()) {
    const core::Membership& m = ring.node(id).membership();
    if (m.state() == core::NodeState::up && m.ring_size() == ring.order().size()) continue;
    return Violation{Promise::whole_again, ring.now(),
                     "node " + std::to_string(id) + " is " + to_string(m.state()) + " in a ring of " +
                         std::to_string(m.ring_size()) + " after all was mended"};
  }
  return std::nullopt;
}

std::optional<Violation> not_silent(const VirtualRing& ring, std::uint64_t slices) {
  if (slices == 0) return std::nullopt;
  return Violation{Promise::whole_again, ring.now(),
                   std::to_string(slices) + " slices that are no beacon's still circulate"};
}

}  // namespace limb_ring::sim
