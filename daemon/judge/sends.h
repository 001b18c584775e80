#pragma once

#include "judge/judge_report.h"
#include "judge/seen_ring.h"

namespace limb_ring::promises {

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
