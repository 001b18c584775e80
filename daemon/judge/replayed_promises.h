#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <vector>

#include "judge/node_observer.h"
#include "judge/promise_judge.h"
#include "judge/replayed_ring.h"

namespace limb_ring::recorder {

/// Judges the ring's promises over all nodes of a replayed ring together. A recording may begin in the middle of a
/// life, and end with the process. What cannot be judged because of that is counted. (ours)
class ReplayedPromises {
 public:
  /// @param ring must outlive this
  explicit ReplayedPromises(ReplayedRing& ring, const promises::JudgeTimes& times = {},
                            core::Duration goes_on = std::chrono::milliseconds(50),
                            std::chrono::nanoseconds round = std::chrono::milliseconds(100));
  ~ReplayedPromises();

  /// That life has done one more record.
  void has_done(ReplayedLife& life);
  /// Nothing more will be done.
  void finish();

  const std::vector<promises::Breach>& breaches() const { return breaches_; }
  const promises::JudgeCounts& counts() const { return judge_.counts(); }

 private:
  class NodeHistory;

  void begin(ReplayedLife& life);
  void end(ReplayedLife& life);

  ReplayedRing& ring_;
  core::Duration goes_on_;
  std::chrono::nanoseconds round_, round_ends_;
  std::vector<promises::Breach> breaches_;
  promises::PromiseJudge judge_;
  std::map<ReplayedLife*, std::unique_ptr<NodeHistory>> histories_;
};

}  // namespace limb_ring::recorder
