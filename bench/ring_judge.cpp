#include "bench/ring_judge.h"

#include <stdexcept>
#include <thread>

#include "bench/cores.h"
#include "bench/waits.h"
#include "ring/promise_watch.h"

namespace limb_ring::bench {

RingJudge::RingJudge(const Setup& setup, const PrivateRing& ring, Pinning pinning)
    : seen_(std::make_unique<Shared<Seen>>(1)) {
  Seen& seen = (*seen_)[0];
  worker_ = std::make_unique<Worker>([&] {
    stay_on(cores_for(pinning));
    live::PromiseWatch watch({ring.name(), ring.config().node_ids()},
                             [&seen](const promises::Breach&) { seen.broken = true; });
    for (;; std::this_thread::sleep_for(live::PromiseWatch::kRound)) {
      watch.poll();
      seen.ready = watch.watched() == ring.config().nodes.size();
    }
  });
  if (!worker_->sets(seen.ready, setup.poll, kPatience))
    throw std::runtime_error("the ring's promises could not be judged");
}

void RingJudge::require_kept() const {
  if ((*seen_)[0].broken) throw std::runtime_error("a promise of the measured ring was found broken");
}

}  // namespace limb_ring::bench
