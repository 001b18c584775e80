#include "judge/replayed_promises.h"

#include <algorithm>
#include <variant>

namespace limb_ring::recorder {

using promises::NodeObserver;
using promises::Observation;
using promises::PromiseJudge;
using std::chrono::nanoseconds;

namespace {

/// Rounds after the last record, so that everything that can be judged is.
constexpr int kLastRounds = 4;

}  // namespace

/// One life, as its recorder has seen it.
class ReplayedPromises::NodeHistory final : promises::ObservationSink {
 public:
  NodeHistory(ReplayedLife& life, PromiseJudge& judge, core::Duration goes_on)
      : judge_(judge),
        id_(life.node()),
        observer_(
            life.title().settings, nanoseconds(life.title().zero),
            [&life] { return life.replay().controller().received_waiting(); }, *this, goes_on) {}

  void see(const Replay& replay) {
    const Record& record = replay.last();
    if (const auto* input = std::get_if<core::Input>(&record.what)) observer_.goes_in(*input, record.at);
    if (const auto* event = std::get_if<core::Event>(&record.what)) observer_.taken(*event, record.at);
    if (std::holds_alternative<Taken>(record.what)) observer_.taken(replay.taken(), record.at);
  }

 private:
  void put(const Observation& seen) override { judge_.see(id_, seen); }

  PromiseJudge& judge_;
  std::uint8_t id_;
  NodeObserver observer_;
};

ReplayedPromises::ReplayedPromises(ReplayedRing& ring, const promises::JudgeTimes& times, core::Duration goes_on,
                                   nanoseconds round)
    : ring_(ring),
      goes_on_(goes_on),
      round_(round),
      round_ends_(ring.began() + round),
      judge_(
          ring.lives().front()->title().settings.fold_back,
          [this](const promises::Breach& breach) { breaches_.push_back(breach); }, times) {}

ReplayedPromises::~ReplayedPromises() = default;

void ReplayedPromises::begin(ReplayedLife& life) {
  const auto state = static_cast<std::uint8_t>(life.replay().controller().membership().state());
  judge_.begins(life.node(), state, promises::longest_send(life.title().settings), life.began().count());
  histories_[&life] = std::make_unique<NodeHistory>(life, judge_, goes_on_);
}

// If a later life of the node follows, the process ended here. Otherwise the file was merely saved before the others,
// and what other nodes did after its last record cannot be judged.
void ReplayedPromises::end(ReplayedLife& life) {
  const auto follows = [&](const auto& other) { return other->node() == life.node() && other->began() > life.began(); };
  if (std::any_of(ring_.lives().begin(), ring_.lives().end(), follows) && !life.replay().difference())
    judge_.ends(life.node());
  else
    judge_.leaves(life.node());
}

void ReplayedPromises::has_done(ReplayedLife& life) {
  const Record& record = life.replay().last();
  for (const nanoseconds now = life.machine_time(record.at); now >= round_ends_; round_ends_ += round_)
    judge_.round_is_over();
  if (histories_.count(&life) == 0) begin(life);
  if (!life.replay().difference()) histories_[&life]->see(life.replay());
  if (life.replay().difference() || life.replay().next() == core::kNever) end(life);
}

void ReplayedPromises::finish() {
  for (int i = 0; i < kLastRounds; ++i) judge_.round_is_over();
}

}  // namespace limb_ring::recorder
