#pragma once

#include <optional>

#include "judge/seen_ring.h"

namespace limb_ring::promises {

/// Whether the result of a send says what has happened. (ours)
class ResultJudge {
 public:
  /// @param fold_back the ring has a second line
  ResultJudge(SeenRing& ring, JudgeReport& report, const JudgeTimes& times, bool fold_back)
      : ring_(ring), report_(report), times_(times), fold_back_(fold_back) {}

  /// Judges what can be, and forgets what is done with.
  void settle(Flow& flow);

 private:
  bool judge(Flow& flow, Sent& sent);
  bool judge_open(Flow& flow, Sent& sent);
  bool judge_unicast(Flow& flow, Sent& sent);
  bool judge_taken(Flow& flow, Sent& sent);
  bool judge_missing(Flow& flow, Sent& sent, std::uint8_t receiver);
  bool judge_broadcast(Flow& flow, Sent& sent);
  std::optional<Unjudged> excuse(const Flow& flow, const Sent& sent, std::uint8_t receiver) const;
  bool may_turn_back(const Sent& sent) const;
  bool must_come(const Flow& flow, const Sent& sent, std::uint8_t receiver) const;
  void forget_first(Flow& flow);
  void note_former(const Flow& flow, Sent& sent, std::uint8_t receiver);
  bool is_done_with(const Flow& flow, const Sent& sent) const;
  bool is_over_at(std::uint8_t receiver, const Flow& flow, const Sent& sent) const;
  bool is_over_everywhere(const Flow& flow, const Sent& sent) const;
  bool is_in_ring_since(std::uint8_t id, const Sent& sent) const;
  bool taken_for_other(Flow& flow, Sent& sent, std::uint8_t receiver);
  bool other_was_meant(Flow& flow, Sent& sent, std::uint8_t receiver);

  SeenRing& ring_;
  JudgeReport& report_;
  const JudgeTimes& times_;
  bool fold_back_;
};

}  // namespace limb_ring::promises
