#pragma once

#include "judge/arrivals.h"
#include "judge/result_judge.h"

namespace limb_ring::promises {

/// Judges a ring's promises over all of its nodes together: each send has one result, what is delivered has arrived, at
/// most once and in order, pins are pulled once, nothing circles. It is told what was seen at each node, living or
/// recorded.
///
/// It never compares the clocks of two nodes. Observations come in rounds: for all that was seen at a node by the end
/// of one round, the causes at other nodes have been seen by the end of the next. So in each round the caller must pass
/// on everything that each node has, or, if all nodes share a clock, everything in order of time. (ours)
class PromiseJudge {
 public:
  using OnBreach = JudgeReport::OnBreach;
  /// @param fold_back the ring has a second line
  PromiseJudge(bool fold_back, OnBreach on_breach, const JudgeTimes& times = {})
      : times_(times),
        report_(std::move(on_breach), times.told_again),
        result_judge_(ring_, report_, times_, fold_back) {}

  /// From now on that node is seen. @param state as Observation::detail. @param longest_send see longest_send()
  void begins(std::uint8_t node, std::uint8_t state, std::chrono::nanoseconds longest_send, std::int64_t at_ns);
  void see(std::uint8_t node, const Observation& seen);
  /// Observations of that node are missing here, perhaps of minutes: it is seen again from the next one on.
  void lost(std::uint8_t node, std::uint64_t count);
  /// Its daemon has ended or is ending. More of its observations may follow, and its next life may already send unseen.
  void closes(std::uint8_t node) { ring_.at(node).closing = true; }
  /// It is dead; all there was has been told.
  void ends(std::uint8_t node);
  /// Nobody looks at it any more.
  void leaves(std::uint8_t node);
  void round_is_over();

  const JudgeCounts& counts() const { return report_.counts; }

 private:
  void looks_at(std::uint8_t id, std::uint8_t state, std::chrono::nanoseconds longest_send, std::int64_t at_ns);
  void changed_state(std::uint8_t id, std::uint8_t after);

  const JudgeTimes times_;
  SeenRing ring_;
  JudgeReport report_;
  Sends sends_{ring_, report_, times_};
  Arrivals arrivals_{ring_, report_, times_};
  ResultJudge result_judge_;
};

}  // namespace limb_ring::promises
