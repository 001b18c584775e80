#pragma once

#include "judge/result_judge.h"
#include "judge/seen_ring.h"

namespace limb_ring::promises {

/// What CPUs were given and pins were pulled for, each found among what was asked for: whole, once, in order. (ours)
class Arrivals {
 public:
  Arrivals(SeenRing& ring, JudgeReport& report, const JudgeTimes& times)
      : ring_(ring), report_(report), times_(times) {}

  /// A CPU was given a packet, or a pin was pulled.
  void taken(std::uint8_t id, const Observation& seen);
  /// A broadcast has passed that node.
  void passed(std::uint8_t id, const Observation& seen);
  /// At the end of a round: matches what still waited for its send. What then has none after a whole round is judged.
  void settle(std::uint8_t receiver);

 private:
  bool match(std::uint8_t receiver, const Pending& came, bool all_asked);
  bool ended_before_known(std::uint8_t receiver, const Sent& sent) const;
  Sent* find(std::uint8_t receiver, Flow* flow, const Pending& came, bool all_asked) const;
  bool mark_passed(std::uint8_t id, const Observation& seen);
  bool certain(std::uint8_t receiver, const Pending& pending) const;
  void classify(std::uint8_t receiver, const Pending& pending);
  bool judge_alike(std::uint8_t receiver, const Pending& came, Flow* from);

  SeenRing& ring_;
  JudgeReport& report_;
  const JudgeTimes& times_;
};

/// What the sources were asked to send, and how that ended: each send has one result. (ours)
class Sends {
 public:
  Sends(SeenRing& ring, JudgeReport& report, const JudgeTimes& times) : ring_(ring), report_(report), times_(times) {}

  void asked(std::uint8_t id, const Observation& seen);
  void ended(std::uint8_t id, const Observation& seen);
  /// Ends that node's open sends: their results will never be seen.
  void cut_short(std::uint8_t id);
  /// They are judged no more.
  void forget(std::uint8_t id, Unjudged why);

 private:
  Sent* find_open(std::uint8_t id, const Observation& seen);
  void ended_again(std::uint8_t id, const Observation& seen);
  template <class Visit>
  bool any_flow(std::uint8_t id, const Observation& ended, Visit visit);

  SeenRing& ring_;
  JudgeReport& report_;
  const JudgeTimes& times_;
};

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
