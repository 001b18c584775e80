#include "study/measure/packet_count.h"
#include "study/measure/round_trips.h"
#include "study/comparison/offered_load.h"
#include "study/analysis/ring_bounds.h"
#include "sim/watched_ring.h"
#include "study/comparison/ring_feed.h"
#include "study/analysis/model_ring.h"

namespace limb_ring::study {

namespace {

/// Sees what the feed, which takes the ring's callbacks, sees as well.
struct Ends : sim::Observer {
  Latencies round_trips;
  void event(NodeId, const core::Event& event) override {
    const auto* end = std::get_if<core::SendEnded>(&event.what);
    if (end && end->owner != core::kController) round_trips.add(end->round_trip);
  }
};

}  // namespace

Latencies data_round_trips(const Medium& medium, double load, std::uint64_t seed) {
  Random random(seed);
  const Duration span = packet_count(medium) * packet_time(medium);
  const std::vector<Message> messages = random_load(medium, load, Time{}, span, random);
  Ends ends;
  sim::WatchedRing ring(ring_options(medium));
  join_and_settle(ring, medium);
  ring.add_observer(ends);
  RingFeed feed(ring, messages);
  const auto all_back = [&] { return ends.round_trips.count() == messages.size(); };
  ring.run_until(all_back, core::kNever - ring.now());
  ring.check();
  return ends.round_trips;
}

}  // namespace limb_ring::study
