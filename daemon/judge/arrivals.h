#pragma once

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
  Sent* find(std::uint8_t receiver, const Flow* flow, const Pending& came, bool all_asked) const;
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

}  // namespace limb_ring::promises
