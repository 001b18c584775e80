#pragma once

#include "judge/judge_report.h"
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
  Sent* next_in_order(std::uint8_t receiver, Flow* flow, const Pending& came, bool all_asked);
  bool mark_passed(std::uint8_t id, const Observation& seen);
  bool certain(std::uint8_t receiver, const Pending& pending) const;
  void classify(std::uint8_t receiver, const Pending& pending);
  bool judge_alike(std::uint8_t receiver, const Pending& came, Flow* from);

  SeenRing& ring_;
  JudgeReport& report_;
  const JudgeTimes& times_;
};

}  // namespace limb_ring::promises
